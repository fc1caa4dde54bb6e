// Sorts the table of cases by any of their numbers; the one sorted by is shown in the last column. Shows the cases that
// a search finds, and draws one number of theirs over another.
"use strict";
const results = JSON.parse(document.getElementById("results").textContent);
const table = document.querySelector(".cases"), body = table.tBodies[0];
const rows = [...body.rows].map((row, place) => ({ row, place, values: results.cases[place] }));
const chosen = document.getElementById("by"), descending = document.getElementById("down");
const last = table.tHead.rows[0].lastElementChild;

// A value to five digits, or to those that a number near it needs to look different.
function text(value, digits = 5) {
  if (typeof value !== "number") return value ?? "–";
  const rounded = Number(value.toPrecision(digits));
  return Math.abs(rounded) < 1e6 ? String(rounded) : rounded.toExponential().replace("e+", "e");
}

function sort() {
  const key = chosen.value, sign = descending.checked ? -1 : 1;
  const isColumn = [...table.querySelectorAll("th[data-key]")].some(head => head.dataset.key === key);
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

const searched = document.getElementById("find"), count = document.getElementById("count");
const sections = new Map([...document.querySelectorAll("section[data-case]")].map(one => [one.dataset.case, one]));
const plain = name => name.toLowerCase().replace(/[\s_.]/g, "");
for (const item of rows) {
  const { textContent } = item.row.querySelector(".name");
  item.text = [textContent, item.row.querySelector(".mark").textContent, ...results.inputs.filter(key =>
    key in item.values).map(key => `${results.labels[key]} ${text(item.values[key])}`)].join(" ").toLowerCase();
}

// Whether a case has a word in its name, its title or what the decks differ in: a number there begins with the word's
// digits. Of a word such as slip_length>2, whether a number whose name ends so compares so.
function has(item, word) {
  const [, name, sign, limit] = word.match(/^(.+?)(<=|>=|<|>|=)(.+)$/) ?? [];
  const close = value => Math.abs(value - limit) <= 1e-5 * Math.abs(limit);
  if (sign && !isNaN(limit)) return Object.entries(item.values).some(([key, value]) => typeof value === "number" &&
    plain(key).endsWith(plain(name)) && (close(value) ? sign.includes("=") :
    sign[0] === "<" ? value < limit : sign[0] === ">" && value > limit));
  const escaped = word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
  return new RegExp(/^\d/.test(word) ? `(^|[^\\d.])${escaped}` : escaped).test(item.text);
}

function find() {
  const words = searched.value.toLowerCase().split(/\s+/).filter(Boolean);
  let found = 0;
  for (const item of rows) {
    const isFound = words.every(word => has(item, word));
    item.row.hidden = !isFound;
    const section = sections.get(item.values.case);
    if (section) section.hidden = !isFound;
    found += isFound;
  }
  count.textContent = words.length ? `${found} of ${rows.length}` : "";
  draw();
}

const over = document.getElementById("over"), drawn = document.getElementById("drawn");
const chart = document.getElementById("chart");

// Round numbers that divide a range into about five parts, their texts, and the range that they span. Values that differ
// by rounding are equal.
function scale(values) {
  let low = Math.min(...values), high = Math.max(...values);
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (high - low < 1e-6 * size) low = high = (low + high) / 2;
  const width = high - low || size || 1;
  const power = 10 ** Math.floor(Math.log10(width / 5));
  const step = power * [1, 2, 5, 10].find(one => one * power >= width / 5);
  const first = Math.floor((high > low ? low : low - width / 2) / step);
  const last = Math.max(first + 1, Math.ceil((high > low ? high : high + width / 2) / step));
  const ticks = Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
  const digits = Math.max(5, Math.ceil(Math.log10(size / step || 1)) + 1);
  return { ticks, texts: ticks.map(tick => text(tick, digits)), at: value => (value - ticks[0]) / (ticks[ticks.length - 1] - ticks[0]) };
}

function add(name, attributes, content = "", parent = chart) {
  const element = document.createElementNS(chart.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.textContent = content;
  parent.append(element);
  return element;
}

function draw() {
  if (!chart) return;
  chart.replaceChildren();
  const known = value => typeof value === "number";
  const shown = rows.filter(item => !item.row.hidden && known(item.values[over.value]) &&
    known(item.values[drawn.value]));
  if (!shown.length) return;
  // One unit is one pixel, so that the texts have one size on a desk and on a phone.
  const width = Math.max(280, chart.clientWidth), height = Math.min(360, 0.75 * width);
  const left = 76, bottom = 46, right = 30, top = 14;
  chart.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const x = scale(shown.map(item => item.values[over.value])), y = scale(shown.map(item => item.values[drawn.value]));
  const across = value => left + x.at(value) * (width - left - right);
  const up = value => height - bottom - y.at(value) * (height - bottom - top);
  // Where texts would meet, every other one is left out.
  const room = (width - left - right) / (x.ticks.length - 1), longest = Math.max(...x.texts.map(one => one.length));
  const every = Math.ceil((8 * longest + 8) / room);
  for (const [i, tick] of x.ticks.entries()) {
    add("line", { x1: across(tick), x2: across(tick), y1: top, y2: height - bottom, class: "grid" });
    if (i % every === 0) add("text", { x: across(tick), y: height - bottom + 16, "text-anchor": "middle" }, x.texts[i]);
  }
  for (const [i, tick] of y.ticks.entries()) {
    add("line", { x1: left, x2: width - right, y1: up(tick), y2: up(tick), class: "grid" });
    add("text", { x: left - 6, y: up(tick) + 4, "text-anchor": "end" }, y.texts[i]);
  }
  add("text", { x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle" }, results.labels[over.value]);
  add("text", { transform: `translate(14 ${(top + height - bottom) / 2}) rotate(-90)`, "text-anchor": "middle" },
    results.labels[drawn.value]);
  for (const item of shown) {
    const link = add("a", { href: `#${item.values.case}` });
    const place = { cx: across(item.values[over.value]), cy: up(item.values[drawn.value]), r: 4 };
    const point = add("circle", { ...place, class: results.colors[item.values.verdict] }, "", link);
    add("title", {}, `${item.values.case}: ${text(item.values[over.value])}, ${text(item.values[drawn.value])}`, point);
  }
}

if (chart) {
  over.value = results.chart[0];
  drawn.value = results.chart[1];
  over.addEventListener("change", draw);
  drawn.addEventListener("change", draw);
  addEventListener("resize", draw);
}
searched.addEventListener("input", find);
find();
