// What the page of the studio does in the browser by itself: keys, and what is kept while the server is away.
(() => {
  document.documentElement.lang = "en";
  // Ctrl+Enter generates. Undo and redo are the studio's. A text field has its own while its text differs from the one that was taken last;
  // anywhere else the browser would undo what was once typed into a field, behind the back of the table.
  // What the page itself puts into a field, after an undo for one, is not typed.
  const taken = new WeakMap(), typed = new WeakSet();
  const isField = (element) => element instanceof HTMLInputElement || element instanceof HTMLTextAreaElement;
  const take = ({ target }) => {
    if (!isField(target)) return;
    typed.delete(target);
    taken.set(target, target.value);
  };
  const isTyped = (field) => typed.has(field) && taken.get(field) !== field.value;
  document.addEventListener("input", ({ target }) => isField(target) && typed.add(target), true);
  document.addEventListener("focusin", take, true);
  document.addEventListener("change", take, true);
  document.addEventListener(
    "keydown",
    (event) => {
      const key = event.key.toLowerCase();
      if ((event.ctrlKey || event.metaKey) && key === "enter" && !event.repeat && !document.querySelector(".q-dialog")) {
        leave(); // what is being typed belongs to the table
        document.querySelector(".studio-generate")?.click();
      }
      if (!(event.ctrlKey || event.metaKey) || event.altKey || !["z", "y"].includes(key)) return;
      const { target } = event;
      if (isTyped(target)) return;
      event.preventDefault();
      if (target.closest?.(".ag-cell-inline-editing")) return; // Esc leaves the cell as it was
      if (document.querySelector(".studio-table") && !document.querySelector(".q-dialog")) emitEvent("dh-undo", event.shiftKey || key === "y");
    },
    true,
  );

  // What is pasted, as text: null where it is none. The text that browsers make of a table of a page has raised digits, as of
  // a footnote, behind the others, and lacks the cells that a cell above spans: there the table itself is read.
  const MOST_CELLS = 100_000;
  const spread = (table) => {
    const rows = Array.from(table.rows, () => []);
    [...table.rows].forEach((row, at) => {
      let column = 0;
      for (const cell of row.cells) {
        while (rows[at][column] !== undefined) column += 1;
        const text = cell.textContent.replace(/\s+/g, " ").trim();
        const below = Math.min(cell.rowSpan, rows.length - at);
        for (let down = 0; down < below; down++)
          for (let right = 0; right < cell.colSpan; right++) rows[at + down][column + right] = down || right ? "" : text;
        column += cell.colSpan;
      }
    });
    return rows.map((row) => Array.from(row, (text) => text ?? "").join("\t"));
  };
  const pasted = ({ clipboardData: data }) => {
    if (data.types.length && !data.types.includes("text/plain")) return null; // none: an empty cell
    const text = data.getData("text/plain"), page = new DOMParser().parseFromString(data.getData("text/html"), "text/html");
    const [table, ...others] = page.querySelectorAll("table");
    if (!table || others.length || table.querySelectorAll("td, th").length > MOST_CELLS) return text;
    let differs = Boolean(table.querySelector("[rowspan]:not([rowspan='1']), [colspan]:not([colspan='1'])"));
    for (const raised of table.querySelectorAll("sup")) {
      const before = page.createRange(), said = raised.textContent.trim();
      before.setStart(raised.closest("td, th") ?? table, 0);
      before.setEndBefore(raised);
      if (!/[\d)]\s*$/.test(before) || !/^[-+−\w°º∘]/.test(said)) continue;
      raised.textContent = /^[o°º∘]$/.test(said) ? "°" : `^${said}`;
      differs = true;
    }
    if (!differs) return text;
    for (const gap of table.querySelectorAll("br, p, div")) gap.after(" ");
    const lines = text.split(/\r?\n/), isRow = (line) => line.includes("\t");
    const last = lines.findLastIndex(isRow);
    return [...lines.slice(0, Math.max(lines.findIndex(isRow), 0)), ...spread(table), ...(last < 0 ? [] : lines.slice(last + 1))].join("\n");
  };

  // What is pasted while the table is empty begins it, wherever the cursor is: at first it is in the field of axes.
  document.addEventListener("paste", (event) => {
    const { target } = event, text = pasted(event) ?? "";
    if (!document.querySelector(".studio-table") || document.querySelector(".q-dialog, .dh-table .ag-row")) return;
    if (!/[\t\n;|,]/.test(text.trim()) || (isField(target) && !target.closest(".studio-axes"))) return;
    event.preventDefault();
    emitEvent("dh-paste", text);
  });

  // While the server is away nothing can be done to the table: it would be lost. The browser keeps the table of this tab,
  // and a server that does not know it is given it back, if a person wants that.
  const KEPT = "dh2urdf-table", UNFINISHED = "dh2urdf-unfinished";
  let keys = []; // of the rows of the table that is kept
  // Row, field and text of the cell that is being typed, the row by its key; for a text of the whole table, as its name, the row is null.
  const unfinished = () => {
    const cell = window.dhGrid?.unfinished(), field = document.activeElement;
    if (cell) return [cell.row, cell.field, cell.text];
    return field?.dataset.text && isTyped(field) ? [null, field.dataset.text, field.value] : null;
  };
  // What is being typed is not in the table of the server yet, but it is in the table that is kept.
  const keepUnfinished = () => {
    const left = unfinished(), kept = JSON.parse(sessionStorage.getItem(KEPT) || "null");
    const texts = left && (left[0] === null ? kept : kept?.rows?.[keys.indexOf(left[0])]);
    if (!texts) return;
    sessionStorage.setItem(UNFINISHED, JSON.stringify(left));
    texts[left[1]] = left[2];
    sessionStorage.setItem(KEPT, JSON.stringify(kept));
  };
  const away = (lost) => {
    const page = document.querySelector(".studio");
    if (!page) return;
    if (lost) keepUnfinished(), leave(); // it is sent when the connection is back, unless the page is loaded anew
    page.inert = lost;
    page.classList.toggle("studio-lost", lost);
    document.querySelector(".studio-away")?.remove();
    if (!lost) return void comeBack();
    const told = document.createElement("div");
    told.className = "studio-away";
    told.setAttribute("role", "alert");
    told.textContent = document.querySelector(".studio-table")
      ? "The studio does not answer. Your table is kept in this tab, and can be edited again when it is back."
      : "The view does not answer. It goes on when it is back.";
    document.body.append(told);
  };
  const watch = () => {
    if (!window.socket) return void setTimeout(watch, 50);
    window.socket.on("disconnect", () => away(true));
    window.socket.on("connect", () => away(false));
  };
  window.addEventListener("load", watch);
  window.addEventListener("pagehide", keepUnfinished);

  // A link holds the table in its fragment, which no browser sends: deflated, in the letters of base64url.
  const LINK = "#table=";
  const LONGEST = 4_000_000; // of the text in a link [B]
  const through = (bytes, stream) => new Blob([bytes]).stream().pipeThrough(stream);
  const link = async (text) => {
    const deflated = await new Response(through(text, new CompressionStream("deflate-raw"))).arrayBuffer();
    const letters = Array.from(new Uint8Array(deflated), (byte) => String.fromCharCode(byte)).join("");
    const word = btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
    return location.origin + location.pathname + LINK + word;
  };
  // The text of the link by which the page was opened: null without one, empty where it is none. It is taken out of the
  // address, so that loading the page anew does not undo what was done since.
  const linked = async () => {
    if (!location.hash.startsWith(LINK)) return null;
    const word = location.hash.slice(LINK.length);
    history.replaceState(null, "", location.pathname + location.search);
    try {
      const bytes = Uint8Array.from(atob(word.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
      const reader = through(bytes, new DecompressionStream("deflate-raw")).getReader();
      const parts = [];
      let length = 0;
      for (let step = await reader.read(); !step.done; step = await reader.read()) {
        length += step.value.length;
        if (length > LONGEST) return "";
        parts.push(step.value);
      }
      return await new Blob(parts).text();
    } catch {
      return "";
    }
  };
  window.addEventListener("hashchange", () => location.hash.startsWith(LINK) && location.reload());

  // Where the cursor was before a dialog, or before the connection broke.
  let before = null;
  document.addEventListener("focusin", ({ target }) => target.closest(".q-dialog, .q-menu") || document.querySelector(".q-dialog") || (before = target), true);

  const focusAgain = () => (before?.isConnected ? before.focus() : window.dhGrid?.focusAgain());
  const comeBack = () => document.activeElement === document.body && focusAgain();
  // Behind a dialog, which may be on its way out, nothing else was meant to get the cursor: Tab leaves it there for a moment.
  const back = () => {
    const around = document.activeElement.closest(".q-dialog, .q-menu");
    around ? around.matches(".q-dialog") && requestAnimationFrame(back) : focusAgain();
  };

  // What opens a dialog or makes a file does so once: more clicks on it do nothing while the answer to the first is on its way.
  const waiting = new Set(); // ids of elements
  const once = (event) => {
    const id = event.target.closest("[data-once]")?.id;
    if (id && waiting.has(id)) event.stopPropagation();
    else if (id) waiting.add(id);
  };
  document.addEventListener("click", once, true);
  document.addEventListener("focusin", ({ target }) => target.closest(".q-dialog") && waiting.clear(), true);

  // Files that a person chooses or drops go to an address of the studio, with the folders that they are in; those whose
  // names end otherwise than is wanted stay here, and so do all of them where they are too much.
  const send = async (address, { ends, most, largest, refused }, given) => {
    const files = given.filter(([path]) => ends.some((end) => path.toLowerCase().endsWith(end)));
    if (!files.length) return emitEvent(refused, "none");
    if (files.length > most || files.reduce((sum, [, { size }]) => sum + size, 0) > largest) return emitEvent(refused, "too much");
    const form = new FormData();
    for (const [path, file] of files) form.append(path, file, encodeURIComponent(path)); // else the folders are cut off
    const answer = await fetch(address, { method: "POST", body: form }).catch(() => null);
    if (!answer?.ok) emitEvent(refused, answer?.status === 413 ? "too much" : "lost");
  };
  const choose = (address, wanted, folder) => {
    const input = document.createElement("input");
    Object.assign(input, { type: "file", multiple: true, webkitdirectory: folder, accept: folder ? "" : wanted.ends.join() });
    input.onchange = () => send(address, wanted, Array.from(input.files, (file) => [file.webkitRelativePath || file.name, file]));
    input.click();
  };
  const within = async (entry) => {
    if (entry.isFile) return [[entry.fullPath.slice(1), await new Promise((done, fail) => entry.file(done, fail))]];
    const reader = entry.createReader(), found = [];
    for (;;) {
      const some = await new Promise((done, fail) => reader.readEntries(done, fail));
      if (!some.length) return found;
      for (const each of some) found.push(...(await within(each)));
    }
  };
  const brings = ({ dataTransfer }) => dataTransfer?.types.includes("Files"); // and not a text that is moved
  const drop = async (event, address, wanted) => {
    if (!brings(event)) return;
    event.preventDefault();
    event.stopPropagation();
    const entries = Array.from(event.dataTransfer.items, (item) => item.webkitGetAsEntry()).filter(Boolean);
    await send(address, wanted, (await Promise.all(entries.map(within))).flat());
  };

  // A file that misses what it was meant for does not take the page away, as a browser would show it in its place.
  for (const kind of ["dragover", "drop"])
    document.addEventListener(kind, (event) => brings(event) && event.preventDefault());
  // Nothing is being typed any more: cells and texts are sent.
  const leave = () => {
    window.dhGrid?.stopEditing();
    document.activeElement?.blur();
  };

  // What is being typed into a field stays there, though a late answer has another text for it; a text that is chosen as a
  // whole stays so. An answer may wait for those before it: the field is looked up when the answer is read.
  const spare = (elements) => {
    const spared = (id, element) => {
      const field = document.activeElement;
      if (!isField(field) || !document.getElementById(`c${id}`)?.contains(field)) return element;
      for (const name of isTyped(field) ? ["value", "model-value"] : []) if (name in element.props) element.props[name] = field.value;
      if (field.value && `${getSelection()}` === field.value) setTimeout(() => isTyped(field) || field.matches(":focus") && field.select());
      return element;
    };
    for (const [id, element] of Object.entries(elements))
      if (element?.props) Object.defineProperty(elements, id, { get: () => spared(id, element) });
    return elements;
  };

  window.dhPage = {
    answered: (id) => waiting.delete(id),
    back,
    choose,
    drop,
    leave,
    link,
    linked,
    pasted,
    spare,
    keep(table, rows) {
      keys = rows;
      sessionStorage.setItem(KEPT, table);
      sessionStorage.removeItem(UNFINISHED); // the server has it
    },
    unfinished: () => JSON.parse(sessionStorage.getItem(UNFINISHED) ?? "null"),
    kept: () => sessionStorage.getItem(KEPT) ?? "",
  };
})();
