// Tables that sort by the column whose heading is pressed; without the script they stay as printed.
// Those of papers and readings have their headings beside the values too, for screens too narrow for columns.
for (const table of document.querySelectorAll("table.trajgap-sortable")) {
  const headings = [...table.querySelectorAll("thead th")].map((one) => one.textContent.trim());
  if (table.matches(".trajgap-papers, .trajgap-readings")) {
    for (const row of table.tBodies[0].rows) {
      [...row.cells].forEach((cell, column) => { cell.dataset.label = headings[column]; });
    }
    table.classList.add("trajgap-labelled");
  }
  table.querySelectorAll("thead th").forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = heading.textContent.trim();
    heading.replaceChildren(button);
    button.addEventListener("click", () => {
      const down = heading.getAttribute("aria-sort") === "ascending";
      table.querySelectorAll("thead th").forEach((other) => other.removeAttribute("aria-sort"));
      heading.setAttribute("aria-sort", down ? "descending" : "ascending");
      const text = (row) => row.cells[column].textContent.trim();
      const rows = [...table.tBodies[0].rows];
      const number = (said) => (/^-?\d+(\.\d+)?(e[-+]?\d+)?\s?%?$/.test(said) ? parseFloat(said) : NaN);
      const order = (a, b) => {
        const apart = number(a) - number(b);
        return Number.isNaN(apart) ? a.localeCompare(b, "en", { numeric: true }) : apart;
      };
      const known = rows.filter((row) => !/^–?$/.test(text(row)));
      known.sort((a, b) => order(text(a), text(b)));
      if (down) known.reverse();
      // What has no value stays below what has one, whichever way the column runs.
      table.tBodies[0].append(...known, ...rows.filter((row) => !known.includes(row)));
    });
  });
}
