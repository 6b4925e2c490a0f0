// What the page of the studio does in the browser by itself: keys, and what is kept while the server is away.
(() => {
  document.documentElement.lang = "en";
  // Ctrl+Enter generates. Undo and redo are the studio's. A text field has its own while its text differs from the one that was taken last;
  // anywhere else the browser would undo what was once typed into a field, behind the back of the table.
  const taken = new WeakMap();
  const isField = (element) => element instanceof HTMLInputElement || element instanceof HTMLTextAreaElement;
  const take = ({ target }) => isField(target) && taken.set(target, target.value);
  document.addEventListener("focusin", take, true);
  document.addEventListener("change", take, true);
  document.addEventListener(
    "keydown",
    (event) => {
      const key = event.key.toLowerCase();
      if ((event.ctrlKey || event.metaKey) && key === "enter" && !event.repeat && !document.querySelector(".q-dialog")) {
        window.dhGrid?.stopEditing(); // what is being typed belongs to the table
        document.activeElement?.blur();
        emitEvent("dh-generate");
      }
      if (!(event.ctrlKey || event.metaKey) || event.altKey || !["z", "y"].includes(key)) return;
      const { target } = event;
      if (isField(target) && taken.get(target) !== target.value) return;
      event.preventDefault();
      if (document.querySelector(".studio-table") && !document.querySelector(".q-dialog")) emitEvent("dh-undo", event.shiftKey || key === "y");
    },
    true,
  );

  // While the server is away nothing can be done to the table: it would be lost. The browser keeps the table of this tab,
  // and a server that does not know it is given it back, if a person wants that.
  const KEPT = "dh2urdf-table";
  const away = (lost) => {
    const page = document.querySelector(".studio");
    if (!page) return;
    page.inert = lost;
    page.classList.toggle("studio-lost", lost);
    document.querySelector(".studio-away")?.remove();
    if (!lost) return;
    const told = document.createElement("div");
    told.className = "studio-away";
    told.setAttribute("role", "alert");
    told.textContent = "The studio does not answer. Your table is kept in this tab, and can be edited again when it is back.";
    document.body.append(told);
  };
  const watch = () => {
    if (!window.socket) return void setTimeout(watch, 50);
    window.socket.on("disconnect", () => away(true));
    window.socket.on("connect", () => away(false));
  };
  window.addEventListener("load", watch);

  window.dhPage = {
    keep: (table) => sessionStorage.setItem(KEPT, table),
    kept: () => sessionStorage.getItem(KEPT) ?? "",
  };
})();
