// What the grid of the table needs beyond AG Grid's own: an editor for joint types, messages of wrong cells, and a row
// that stands out. Loaded once; `window.dhGrid` has the functions that Python calls by name.
(() => {
  const TYPES = ["revolute", "prismatic", "continuous", "fixed"];

  // A text field that offers the joint types, and takes any word that a reader takes.
  class TypeEditor {
    init(params) {
      this.input = document.createElement("input");
      this.input.className = "ag-input-field-input dh-type-editor";
      this.input.setAttribute("list", "dh-joint-types");
      this.input.value = params.eventKey?.length === 1 ? params.eventKey : params.eventKey === "Backspace" ? "" : (params.value ?? "");
      this.typed = params.eventKey?.length === 1;
      if (!document.getElementById("dh-joint-types")) {
        const list = document.createElement("datalist");
        list.id = "dh-joint-types";
        for (const type of TYPES) list.append(new Option(type, type));
        document.body.append(list);
      }
    }
    getGui() {
      return this.input;
    }
    afterGuiAttached() {
      this.input.focus();
      if (!this.typed) this.input.select();
    }
    focusIn() {
      this.input.focus();
      this.input.select();
    }
    getValue() {
      return this.input.value;
    }
  }

  const problem = ({ data, colDef }) => data?.problems?.[colDef.field];

  let asked = false; // whether the arm of what is being typed has been asked for, and is not on the screen yet
  let typed = null; // what has been typed since; of several letters the last one counts
  let home = null; // the column where the row that is being typed began

  // The table is one stop on the way through the page: Tab goes to what comes after it, Shift+Tab to what is before.
  function leave(event) {
    event.preventDefault();
    const table = document.querySelector(".dh-table");
    const side = event.shiftKey ? Node.DOCUMENT_POSITION_PRECEDING : Node.DOCUMENT_POSITION_FOLLOWING;
    const stops = [...document.querySelectorAll("a[href], button, input, select, textarea, [tabindex]")].filter(
      (stop) =>
        stop.tabIndex >= 0 && !stop.disabled && stop.getClientRects().length && !table.contains(stop) &&
        table.compareDocumentPosition(stop) & side,
    );
    stops.at(event.shiftKey ? -1 : 0)?.focus();
  }

  let grid = null; // the table on the page
  let picked = null; // the key of the row that a person has gone to; the server learns of it, and never sets it
  let acts = 0; // how often a person has changed a cell or the rows; an answer has the number of the last one before it
  let arranged = 0; // the number of the last one that added, removed or moved a row
  let unanswered = []; // texts of cells that no answer knows yet: {act, key, field, text}
  let made = 0; // rows that were added
  let anchor = null; // where a range of cells begins: {row, column}
  let last = null; // the cell that was clicked last
  let drawn = []; // the keys of the rows of the arm in the scene
  let end = null; // where it ends; null where one cell is the range

  const place = (api) => {
    const cell = api.getFocusedCell();
    return cell && { row: cell.rowIndex, column: cell.column.colId };
  };
  // A row is known by its key, which it has wherever it goes; its number is that of its place.
  const keyAt = (api, row) => api.getDisplayedRowAtIndex(row)?.data.id;
  const rowsOf = (api) => Array.from({ length: api?.getDisplayedRowCount() ?? 0 }, (_, row) => api.getDisplayedRowAtIndex(row));
  const keysFrom = (api, first, last) => Array.from({ length: last - first + 1 }, (_, at) => keyAt(api, first + at));
  // The rows and fields of the range, or of the cell that has the cursor.
  const range = (api) => {
    const from = end ? anchor : place(api), to = end ?? from;
    if (!from) return null;
    const fields = api.getAllDisplayedColumns().map((column) => column.colId).filter((id) => id !== "number");
    const columns = [from, to].map(({ column }) => Math.max(fields.indexOf(column), 0)).sort((a, b) => a - b);
    const rows = [from.row, to.row].sort((a, b) => a - b);
    return { first: rows[0], last: rows[1], fields: fields.slice(columns[0], columns[1] + 1) };
  };
  const CURSOR = "dh2urdf-cursor";
  if (location.hash) sessionStorage.removeItem(CURSOR); // a link opens another table
  const isHere = () => Boolean(document.activeElement.closest(".dh-table"));
  window.addEventListener("pagehide", () => {
    if (picked) sessionStorage.setItem(CURSOR, JSON.stringify([picked, isHere() ? place(grid)?.column : null]));
  });
  let shown = null; // the range that is marked
  const mark = (api) => {
    const before = shown;
    shown = end ? range(api) : null;
    if (before || shown) api.refreshCells({ force: true });
  };
  const extend = (api, to) => {
    anchor ??= place(api);
    end = to;
    mark(api);
  };
  const collapse = (api) => {
    anchor = end = null;
    mark(api);
  };

  window.dhGrid = {
    TypeEditor,
    // The cell that is being typed, as far as it is typed.
    unfinished() {
      const input = document.querySelector(".dh-table .ag-cell-inline-editing input"), cell = input?.closest(".ag-cell");
      return cell && { row: cell.closest(".ag-row").getAttribute("row-id"), field: cell.getAttribute("col-id"), text: input.value };
    },
    stopEditing: () => grid?.stopEditing(),
    focusAgain() {
      const cell = grid && place(grid);
      if (cell) grid.setFocusedCell(grid.getRowNode(picked)?.rowIndex ?? cell.row, cell.column);
    },
    inRange: ({ colDef, node }) =>
      Boolean(shown) && shown.first <= node.rowIndex && node.rowIndex <= shown.last && shown.fields.includes(colDef.field),

    // A rectangle of cells as spreadsheets copy it: a line a row, tabs between cells. Cut empties them.
    copy(api, event) {
      const cells = range(api);
      if (event.target.tagName === "INPUT" || !cells) return;
      event.preventDefault();
      const lines = [];
      for (let row = cells.first; row <= cells.last; row++) {
        const { data } = api.getDisplayedRowAtIndex(row);
        lines.push(cells.fields.map((field) => data[field] ?? "").join("\t"));
      }
      event.clipboardData.setData("text/plain", lines.join("\n"));
      if (event.type === "cut") this.clear(api, cells);
    },

    paste(api, event, emit) {
      const cells = range(api);
      if (event.target.tagName === "INPUT" || !cells?.fields.length) return;
      event.preventDefault();
      const keys = keysFrom(api, cells.first, api.getDisplayedRowCount() - 1);
      emit([keys, cells.fields[0], dhPage.pasted(event)]);
    },

    wrong: (params) => problem(params)?.severity === "error",
    remarked: (params) => problem(params)?.severity === "notice",
    empty: ({ data, value, colDef }) => !value && ["a", "alpha", "d"].includes(colDef.field) && !data?.problems?.[colDef.field],
    tooltip: (params) => problem(params)?.text ?? (params.value?.length > 7 ? params.value : null), // it may be cut
    number: ({ node }) => node.rowIndex + 1,
    numberOf: (key) => (grid?.getRowNode(key)?.rowIndex ?? grid?.getDisplayedRowCount()) + 1,

    // Enter goes on in the next row where this one began, as in spreadsheets: 0 Tab pi/2 Tab 0.1 Enter.
    keys({ event, editing, api, node, column }) {
      if (event.altKey && !editing) {
        const act = { ArrowUp: "up", ArrowDown: "down", Insert: "add", Delete: "remove" }[event.key];
        if (act) this.act(api, act, node, column);
        if (event.key.length > 1) return true;
        if (event.key <= "\x7f") return false;
        event.preventDefault(); // Option+P is a π: the grid begins no cell with a key that Alt is held with
        api.startEditingCell({ rowIndex: node.rowIndex, colKey: column, key: event.key });
        return true;
      }
      if (!editing && this.select(event, api, node, column)) return true;
      if (event.key === "Tab") home ??= column;
      else if (event.key.startsWith("Arrow") && !editing) home = null;
      if (event.key !== "Enter" || !editing) return false;
      api.stopEditing();
      const row = Math.min(Math.max(node.rowIndex + (event.shiftKey ? -1 : 1), 0), api.getDisplayedRowCount() - 1);
      api.setFocusedCell(row, home ?? column);
      return true;
    },

    // A button does the same to the row that is picked; without one, a new row is the last one.
    press(act) {
      const node = rowsOf(grid).find(({ data }) => data.id === picked);
      if (node) this.act(grid, act, node, grid.getFocusedCell()?.column ?? "a");
      else if (act === "add") this.act(grid, act, rowsOf(grid).at(-1), "a");
    },

    // Rows are in their new places at once, and the cursor is with them. The answer to the last act has the rows of all:
    // those of before would put rows back that have gone elsewhere.
    act(api, act, node, column) {
      const row = node?.rowIndex ?? -1, to = row + { up: -1, down: 1, add: 1, remove: 0 }[act];
      const rows = rowsOf(api).map(({ data }) => data);
      if (to < 0 || to >= rows.length + (act === "add")) return void this.focusAgain();
      const own = act === "add" ? { id: this.newKey() } : rows.splice(row, 1)[0];
      this.arrange(act, node?.data.id ?? null, act === "add" ? own.id : null);
      if (act !== "remove") rows.splice(to, 0, own);
      this.put(api, rows);
      if (rows.length) api.setFocusedCell(Math.min(to, rows.length - 1), act === "add" ? "a" : column);
    },
    newKey: () => `${window.clientId} ${(made += 1)}`,
    tell: (event, ...args) => emitEvent(event, [...args, (acts += 1)]),
    arrange(...args) {
      this.tell("dh-act", ...args);
      arranged = acts;
    },

    // The rows of an empty table are there at once, so that what is typed next finds them.
    resize(most) {
      const { value } = document.querySelector(".studio-axes input"), isEmpty = grid && !rowsOf(grid).length;
      const count = value === "" ? null : Number(value);
      const rows = Array.from({ length: isEmpty ? Math.min(Math.max(Math.trunc(count), 0), most) : 0 }, (_, at) => (
        { id: this.newKey(), joint: `joint_${at + 1}`, type: "revolute" }));
      this.tell("dh-axes", count, rows.map(({ id }) => id));
      if (rows.length) arranged = acts, this.put(grid, rows);
      if (document.querySelector(".studio-convention [aria-pressed=true]")) this.begin();
    },
    // The cursor goes to where the table begins, once there are rows and a convention and nothing else.
    begin() {
      const rows = rowsOf(grid), names = ["id", "problems", "joint", "type", "link"];
      const isBlank = ({ data }) => Object.keys(data).every((key) => names.includes(key) || !data[key]);
      if (rows.length && rows.every(isBlank)) this.focus(grid, rows[0].data.id, "a");
    },

    // What an answer knows of the table. Texts that were typed since stay, and so do rows that were arranged since: there
    // is an answer to that, too.
    fill(api, rows, known) {
      this.know(known);
      if (known < arranged) return;
      for (const { key, field, text } of unanswered) Object.assign(rows.find(({ id }) => id === key) ?? {}, { [field]: text });
      this.put(api, rows);
    },
    setCell(api, key, field, text, known) {
      this.know(known);
      const node = api.getRowNode(key);
      if (node && !unanswered.some((one) => one.key === key && one.field === field)) node.data[field] = text;
    },
    know: (known) => (unanswered = unanswered.filter(({ act }) => act > known)),

    // The cursor goes with its row, and what is picked with it; where the row is gone, to the one in its place. What is
    // being typed into a row that is gone is sent, to be refused in words; the letters that follow are not for another row.
    put(api, rows) {
      const cell = place(api), key = cell && keyAt(api, cell.row), typing = this.unfinished(), had = isHere();
      const at = api.getRowNode(picked)?.rowIndex ?? 0, isGone = typing && !rows.some(({ id }) => id === typing.row);
      if (isGone) {
        api.stopEditing();
        api.clearFocusedCell();
        document.activeElement.blur();
      }
      api.setGridOption("rowData", rows);
      api.refreshCells({ columns: ["number"], force: true });
      if (picked && !api.getRowNode(picked)) this.choose(api, Math.min(at, rows.length - 1));
      if (!cell || !rows.length || isGone || !had) return;
      const row = api.getRowNode(key)?.rowIndex ?? Math.min(cell.row, rows.length - 1);
      if (row !== cell.row || !isHere()) api.setFocusedCell(row, cell.column);
      if (typing) document.querySelector(".dh-table .ag-cell-inline-editing input")?.focus();
    },

    // Keys for ranges: Shift and an arrow, Ctrl+A, Delete; the others go back to one cell. Tab leaves the table, which
    // is one stop on the way through the page: inside it arrows lead from cell to cell.
    select(event, api, node, column) {
      const command = event.ctrlKey || event.metaKey;
      const fields = api.getAllDisplayedColumns().map((one) => one.colId).filter((id) => id !== "number");
      if (event.shiftKey && event.key.startsWith("Arrow")) {
        const from = end ?? { row: node.rowIndex, column: column.colId };
        const [down, right] = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
        const within = (number, count) => Math.min(Math.max(number, 0), count - 1);
        const row = within(from.row + down, api.getDisplayedRowCount());
        extend(api, { row, column: fields[within(fields.indexOf(from.column) + right, fields.length)] });
        api.ensureIndexVisible(row);
        return true;
      }
      if (command && event.key.toLowerCase() === "a") {
        event.preventDefault();
        anchor = { row: 0, column: fields[0] };
        extend(api, { row: api.getDisplayedRowCount() - 1, column: fields.at(-1) });
        return true;
      }
      if (event.key === "Delete") {
        this.clear(api, range(api));
        return true;
      }
      if (event.key === "Tab") {
        leave(event);
        return true;
      }
      if (!command && !["Shift", "Control", "Meta"].includes(event.key)) collapse(api);
      return false;
    },

    // Told at once: the grid's own event comes later, behind a key that is pressed next.
    clicked(api, event) {
      const cell = event.target.closest?.(".ag-row .ag-cell");
      if (!cell) return;
      const row = Number(cell.closest(".ag-row").getAttribute("row-index")), column = cell.getAttribute("col-id");
      home = null;
      if (event.shiftKey && column !== "number") {
        anchor ??= last;
        extend(api, { row, column });
      } else {
        collapse(api);
        last = { row, column };
      }
      this.choose(api, row);
      if (event.button === 0 && column !== "number" && event.target.tagName !== "INPUT") this.sweep(api, { row, column });
    },

    // With the button held, the cells from the one that was pressed to the one below the pointer are chosen.
    sweep(api, from) {
      const move = ({ target }) => {
        const cell = target.closest?.(".dh-table .ag-row .ag-cell"), column = cell?.getAttribute("col-id");
        if (!cell || column === "number") return;
        const to = { row: Number(cell.closest(".ag-row").getAttribute("row-index")), column };
        const now = end ?? from;
        if (to.row === now.row && to.column === now.column) return;
        anchor ??= from;
        extend(api, to);
      };
      document.addEventListener("mousemove", move);
      document.addEventListener("mouseup", () => document.removeEventListener("mousemove", move), { once: true });
    },

    // At once for the same reason.
    edited({ data, colDef: { field }, newValue }) {
      const text = (newValue ?? "").slice(0, 10_000); // a cell is shorter, and a message of a megabyte is not sent
      this.tell("dh-edit", data.id, field, text);
      this.write(data, field, text);
      return true;
    },
    clear(api, { first, last, fields }) {
      this.tell("dh-clear", keysFrom(api, first, last), fields);
      for (const { data } of rowsOf(api).slice(first, last + 1)) for (const field of fields) this.write(data, field, "");
      api.refreshCells({ force: true });
    },
    write(data, field, text) {
      data[field] = text;
      unanswered.push({ act: acts, key: data.id, field, text });
    },

    // A row was dragged elsewhere.
    dragged({ api, node }) {
      this.arrange("to", node.data.id, keyAt(api, node.rowIndex - 1) ?? null);
      this.put(api, rowsOf(api).map(({ data }) => data));
    },

    // Problems by row and field. What is being typed is left alone.
    mark(api, problems) {
      grid = api;
      api.forEachNode(({ data }) => (data.problems = problems[data.id] ?? {}));
      api.refreshCells({ force: true });
      this.pick(picked);
      this.comeBack(api);
      if (!api.getEditingCells().length) this.widen(api);
    },

    // The row that a person has gone to is picked at once: what a button does is done to that.
    choose(api, row) {
      const key = keyAt(api, row) ?? null;
      if (key === picked) return;
      this.pick(key);
      emitEvent("dh-focus", key);
    },
    focusin() {
      const cell = grid && place(grid);
      if (cell) this.choose(grid, cell.row);
    },
    pick(key) {
      picked = key;
      for (const row of document.querySelectorAll(".dh-table .ag-row"))
        row.classList.toggle("dh-picked", row.getAttribute("row-id") === picked);
    },

    // The row of a link of the scene, which may show the arm that the table had before something was wrong with it.
    draw: (api, keys) => (drawn = keys),
    chooseDrawn({ row }) {
      const node = row === null ? null : grid?.getRowNode(drawn[row]);
      if (!grid || node === undefined) return;
      this.choose(grid, node?.rowIndex ?? -1);
      if (node) this.focus(grid, node.data.id, "a");
    },

    // A cursor that is in the table already stays: its person has gone on.
    focus(api, key, field, edit) {
      if (!edit && document.activeElement.closest(".dh-table .ag-cell")) return;
      const row = api.getRowNode(key)?.rowIndex;
      if (row === undefined) return;
      api.ensureIndexVisible(row);
      api.ensureColumnVisible(field);
      api.setFocusedCell(row, field);
      if (edit) api.startEditingCell({ rowIndex: row, colKey: field });
    },

    // The cell, or the field below the table, that a problem is about.
    goTo(key, field) {
      if (key === null) document.querySelector(`[data-text="${field}"]`)?.focus();
      else this.focus(grid, key, field, true);
    },

    // What was picked, and the cursor, are where they were when the page was loaded anew, unless a person has gone elsewhere.
    comeBack(api) {
      const [key, column] = JSON.parse(sessionStorage.getItem(CURSOR) ?? "[]");
      if (!key || !api.getDisplayedRowCount()) return;
      sessionStorage.removeItem(CURSOR);
      if (picked === null) this.choose(api, api.getRowNode(key)?.rowIndex ?? -1);
      if (column && document.activeElement === document.body) this.focus(api, key, column);
    },

    // The letter that opens an editor is in it already: the editor gets it like those that follow.
    started({ event }) {
      if (event?.key?.length !== 1) return;
      const tell = (input) => input?.dispatchEvent(new Event("input", { bubbles: true }));
      setTimeout(() => tell(document.querySelector(".dh-table .ag-cell-inline-editing input")));
    },

    input(event) {
      const cell = event.target.closest?.(".ag-cell");
      const row = cell?.closest(".ag-row");
      if (!row || typeof event.target.value !== "string") return;
      typed = [row.getAttribute("row-id"), cell.getAttribute("col-id"), event.target.value];
      if (!asked) this.ask();
    },

    // The next letters are sent when the arm of those before is there, so that a slow machine does not fall behind.
    ask() {
      asked = typed !== null;
      if (asked) emitEvent("dh-typing", typed);
      typed = null;
    },

    // What was typed is sent as a whole. The grid draws a cell that was left as it was from what it had when typing began:
    // an answer may have come since.
    stopped({ api, node, column }) {
      typed = null;
      api.refreshCells({ rowNodes: [node], columns: [column], force: true });
    },
  };
})();
