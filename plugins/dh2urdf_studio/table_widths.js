// How wide the columns of the table are: wide enough for their cells, in the size that text has on the page.
(() => {
  let grid = null; // the table on the page

  // A width in pixels, for text of the size that the page has.
  const size = () => parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;
  let sized = size();
  window.addEventListener("dh-look", () => {
    if (size() !== sized && document.querySelector(".dh-table")) emitEvent("dh-text-size");
    sized = size();
  });
  let resting = 0; // a timer: cells have other margins in a window of another width
  window.addEventListener("resize", () => {
    clearTimeout(resting);
    resting = setTimeout(() => grid && document.querySelector(".dh-table") && dhGrid.widen(grid), 200);
  });
  const WIDEST = 240; // of a column that holds long texts [px], for text of the usual size
  const MEASURED = 200; // rows whose texts decide on the width of a column
  const pen = document.createElement("canvas").getContext("2d");
  // The width that the longest of some texts needs in a kind of cell.
  const needed = (kind, texts) => {
    const example = document.querySelector(`.dh-table ${kind}`);
    if (!example) return 0;
    const { fontStyle, fontWeight, fontSize, fontFamily, paddingLeft, paddingRight } = getComputedStyle(example);
    pen.font = `${fontStyle} ${fontWeight} ${fontSize} ${fontFamily}`;
    return Math.max(...texts.map((text) => pen.measureText(text).width)) + parseFloat(paddingLeft) + parseFloat(paddingRight) + 4;
  };

  const wide = (pixels) => Math.round(pixels * size());

  Object.assign(window.dhGrid, {
    wide,
    // No cell and no head is cut: a column is at least as wide as its longest text in the size that text has now.
    widen(api) {
      grid = api;
      const most = wide(WIDEST);
      const rows = Array.from({ length: Math.min(api.getDisplayedRowCount(), MEASURED) }, (_, row) => api.getDisplayedRowAtIndex(row).data);
      let changed = false;
      const columns = api.getColumnDefs().map((column) => {
        if (column.colId === "number") return column;
        const cells = needed(".ag-cell:not(.dh-number)", rows.map((data) => String(data[column.field] ?? "")));
        const least = Math.ceil(Math.min(Math.max(cells, needed(".ag-header-cell", [column.headerName])), most));
        changed ||= Math.abs(least - column.minWidth) > 1;
        return { ...column, minWidth: least, flex: least };
      });
      if (changed) api.setGridOption("columnDefs", columns);
    },
  });
})();
