"use strict";
(() => {
  const table = document.getElementById("overview");
  if (!table) return;
  const body = table.tBodies[0];
  const rows = [...body.rows];

  // A click on a header sorts by its column; another one the other way round. Empty cells come last.
  const key = (row, column) => {
    const cell = row.cells[column];
    const data = cell.querySelector("data");
    const text = data ? data.value : cell.textContent.trim();
    if (text === "" || text === "–") return null;
    const number = Number(text);
    return Number.isNaN(number) ? text.toLowerCase() : number;
  };
  const compare = (a, b) => {
    if (typeof a === typeof b) return a < b ? -1 : a > b ? 1 : 0;
    return typeof a === "number" ? -1 : 1;
  };
  const headers = [...table.tHead.rows[0].cells];
  headers.forEach((header, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.setAttribute("aria-label", `sort by ${header.textContent.trim()}`);
    header.append(button);
    button.addEventListener("click", () => {
      const falling = header.getAttribute("aria-sort") === "ascending";
      for (const other of headers) other.removeAttribute("aria-sort");
      header.setAttribute("aria-sort", falling ? "descending" : "ascending");
      const keyed = rows.map((row, place) => [key(row, column), place, row]);
      keyed.sort(([a, i], [b, j]) => {
        if (a === null || b === null) return a === b ? i - j : a === null ? 1 : -1;
        return (falling ? -compare(a, b) : compare(a, b)) || i - j;
      });
      body.append(...keyed.map(([, , row]) => row));
    });
  });

  const form = document.querySelector("form.controls");
  const show = () => {
    const { status, name } = Object.fromEntries(new FormData(form));
    const part = name.toLowerCase();
    let count = 0;
    for (const row of rows) {
      const there = row.cells[1].textContent.toLowerCase().includes(part);
      row.hidden = !there || (status !== "" && row.dataset.status !== status);
      count += row.hidden ? 0 : 1;
    }
    form.querySelector("output").textContent = `${count.toLocaleString("en")} shown`;
  };
  form.addEventListener("input", show);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.hidden = false;
  show();
})();
