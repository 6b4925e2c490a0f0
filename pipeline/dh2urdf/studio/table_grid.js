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

  window.dhGrid = {
    TypeEditor,
    wrong: (params) => problem(params)?.severity === "error",
    remarked: (params) => problem(params)?.severity === "notice",
    empty: ({ data, value, colDef }) => !value && ["a", "alpha", "d"].includes(colDef.field) && !data?.problems?.[colDef.field],
    tooltip: (params) => problem(params)?.text ?? null,
    number: ({ node }) => node.rowIndex + 1,

    // Enter goes on in the next row where this one began, as in spreadsheets: 0 Tab pi/2 Tab 0.1 Enter.
    keys({ event, editing, api, node, column }) {
      if (event.altKey && !editing) {
        const act = { ArrowUp: "up", ArrowDown: "down", Insert: "add", Delete: "remove" }[event.key];
        if (act) emitEvent("dh-act", [act, node.rowIndex]);
        return true;
      }
      // Only what a person does moves the picked row: rows that are exchanged take the cursor along.
      setTimeout(() => {
        const row = api.getFocusedCell()?.rowIndex;
        if (row !== undefined && row !== node.rowIndex) emitEvent("dh-focus", row);
      });
      if (event.key === "Tab") home ??= column;
      else if (event.key.startsWith("Arrow") && !editing) home = null;
      if (event.key !== "Enter" || !editing) return false;
      api.stopEditing();
      const row = Math.min(Math.max(node.rowIndex + (event.shiftKey ? -1 : 1), 0), api.getDisplayedRowCount() - 1);
      api.setFocusedCell(row, home ?? column);
      return true;
    },

    clicked({ rowIndex }) {
      home = null;
      emitEvent("dh-focus", rowIndex);
    },

    // A cell as the table has it: what was sent before it was typed may have overtaken it.
    put(api, row, field, text) {
      const node = api.getRowNode(String(row));
      if (node) node.data[field] = text;
    },

    // Problems by row and field, and which row is picked. What is being typed is left alone.
    mark(api, problems, picked) {
      api.forEachNode((node) => {
        node.data.problems = problems[node.data.id] ?? {};
        node.data.picked = node.data.id === picked;
      });
      api.refreshCells({ force: true });
      this.pick(api, picked);
    },

    pick(api, picked) {
      api.forEachNode((node) => (node.data.picked = node.data.id === picked));
      for (const row of document.querySelectorAll(".dh-table .ag-row"))
        row.classList.toggle("dh-picked", row.getAttribute("row-id") === String(picked));
    },

    focus(api, row, field, edit) {
      field ??= api.getFocusedCell()?.column.colId ?? "a";
      if (row < 0 || row >= api.getDisplayedRowCount()) return;
      api.ensureIndexVisible(row);
      api.ensureColumnVisible(field);
      api.setFocusedCell(row, field);
      if (edit) api.startEditingCell({ rowIndex: row, colKey: field });
    },

    // The letter that opens an editor is in it already: it is told like those that follow.
    started({ event }) {
      asked = false; // an answer may have been lost with the connection
      if (event?.key?.length !== 1) return;
      const tell = (input) => input?.dispatchEvent(new Event("input", { bubbles: true }));
      setTimeout(() => tell(document.querySelector(".dh-table .ag-cell-inline-editing input")));
    },

    typing(event) {
      const cell = event.target.closest?.(".ag-cell");
      const row = cell?.closest(".ag-row");
      if (!row || typeof event.target.value !== "string") return;
      typed = [Number(row.getAttribute("row-id")), cell.getAttribute("col-id"), event.target.value];
      if (!asked) this.ask();
    },

    // The next letters are sent when the arm of those before is there, so that a slow machine does not fall behind.
    ask() {
      asked = typed !== null;
      if (asked) emitEvent("dh-typing", typed);
      typed = null;
    },

    stopped: () => (typed = null), // what was typed is sent as a whole
  };
})();
