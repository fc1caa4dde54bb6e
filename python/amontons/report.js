// Sorts the table of cases by any of their numbers; the one sorted by is shown in the last column.
"use strict";
const results = JSON.parse(document.getElementById("results").textContent);
const table = document.querySelector(".cases"), body = table.tBodies[0];
const rows = [...body.rows].map((row, place) => ({ row, place, values: results.cases[place] }));
const chosen = document.getElementById("by"), descending = document.getElementById("down");
const last = table.tHead.rows[0].lastElementChild;

function text(value) {
  return value === null || value === undefined ? "–" : typeof value === "number" ? Number(value.toPrecision(5)) : value;
}

function sort() {
  const key = chosen.value, sign = descending.checked ? -1 : 1, isColumn = table.querySelector(`[data-key="${key}"]`);
  const known = item => item.values[key] !== null && item.values[key] !== undefined;
  rows.sort((one, other) => known(other) - known(one) || (known(one) &&
    sign * (typeof one.values[key] === "number" ? one.values[key] - other.values[key] :
      String(one.values[key]).localeCompare(String(other.values[key]), undefined, { numeric: true }))) ||
    one.place - other.place);
  for (const item of rows) {
    body.append(item.row);
    const cell = item.row.lastElementChild;
    cell.hidden = Boolean(isColumn);
    cell.textContent = text(item.values[key]);
    cell.dataset.label = results.labels[key];
  }
  last.hidden = Boolean(isColumn);
  last.textContent = results.labels[key];
  for (const head of table.querySelectorAll("th[data-key]")) {
    head.removeAttribute("aria-sort");
    if (head.dataset.key === key) head.setAttribute("aria-sort", descending.checked ? "descending" : "ascending");
  }
}

chosen.addEventListener("change", sort);
descending.addEventListener("change", sort);
for (const head of table.querySelectorAll("th[data-key] button")) {
  head.addEventListener("click", () => {
    const key = head.parentElement.dataset.key;
    descending.checked = chosen.value === key ? !descending.checked : key !== "case";
    chosen.value = key;
    sort();
  });
}
sort();
