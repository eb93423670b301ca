// SPDX-License-Identifier: Apache-2.0
// The page of `ssdo bench`: everything comes from the JSON block beside it, which is what
// `--report FILE.json` writes, and the pictures.
"use strict";

const bench = JSON.parse(document.getElementById("data").textContent);
const by = id => document.getElementById(id);
const kColors = {
  bitmask: "#ffb347", trace: "#f2f2f2", ssdo: "#e5675b", ssao: "#6fb7ff", "ssao-range": "#4a84d8",
  "ssao-fade": "#9a8cff", hbao: "#67c98b", gtao: "#c8d65a", sao: "#4fc5c7", msvo: "#e58fd0"};
const kShapes = {
  bitmask: "circle", trace: "star", ssdo: "rectRot", ssao: "triangle", "ssao-range": "rect",
  "ssao-fade": "rectRounded", hbao: "circle", gtao: "rectRot", sao: "triangle", msvo: "rect"};
const kPartNames = {noise: "its own limit (noise)", approximation: "trace (approximation)",
                    model: "truth (model)"};
const methods = [...new Set(bench.rows.map(row => row.method))];
const color = method => kColors[method] || "#aaaaaa";
const nameOf = row => row.method + " " + row.setting;

/// What is looked at: a product, what its error is measured from, and a clock.
const state = {product: bench.products[0], part: "", clock: "cpu", view: "error"};

const partsOf = product => bench.truths[product] ? ["model", "approximation", "noise"]
                                                 : ["approximation", "noise"];
const timeOf = row => row[state.clock + "_ms_per_megapixel"];
const errorOf = row => row.errors[state.product] ? row.errors[state.product][state.part] : null;
const rowsShown = () => bench.rows.filter(row => errorOf(row) !== null);

function element(tag, text, parent) {
  const e = document.createElement(tag);
  if (text !== undefined) e.textContent = text;
  if (parent) parent.append(e);
  return e;
}

/// Three figures, without exponents where people have none.
function figure(value) {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  const digits = Math.max(0, 2 - Math.floor(Math.log10(Math.abs(value))));
  return value.toFixed(Math.min(digits, 5));
}

/// The rows of which no other is both as cheap and as good, cheapest first: as pareto_front() does
/// it, but for the clock and the reference that are chosen here.
function front() {
  const sorted = rowsShown().sort((a, b) => timeOf(a) - timeOf(b) || errorOf(a) - errorOf(b));
  let least = Infinity;
  return sorted.filter(row => errorOf(row) < least && ((least = errorOf(row)), true));
}

// --- Speed and error ---

Chart.defaults.color = "#a8a8ab";
Chart.defaults.borderColor = "#38383b";
Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
Chart.defaults.font.size = 13;
Chart.defaults.animation = false;
Chart.defaults.maintainAspectRatio = false;

/// 1, 2 and 5 times powers of ten between two values.
function logTicks(low, high) {
  const ticks = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
    for (const m of [1, 2, 5]) {
      const value = m * Math.pow(10, e);
      if (value >= low * 0.999 && value <= high * 1.001) ticks.push({value});
    }
  }
  return ticks;
}

function logAxis(title, values) {
  const low = Math.min(...values) / 1.25, high = Math.max(...values) * 1.25;
  return {
    type: "logarithmic", min: low, max: high,
    title: {display: true, text: title, color: "#d8d8d8"},
    afterBuildTicks: axis => { axis.ticks = logTicks(low, high); },
    ticks: {callback: value => Number(value.toPrecision(3)).toString(), autoSkip: false, maxRotation: 0}};
}

/// Names the points of the front, where there is room beside them.
const frontNames = {
  id: "frontNames",
  afterDatasetsDraw(chart) {
    const index = chart.data.datasets.findIndex(set => !set.method);
    if (index < 0 || chart.getDatasetMeta(index).hidden) return;
    const {ctx: context, chartArea: area} = chart;
    const taken = chart.data.datasets.flatMap((set, i) => set.method && chart.isDatasetVisible(i) ?
        chart.getDatasetMeta(i).data.map(p => ({left: p.x - 6, right: p.x + 6, top: p.y - 6, bottom: p.y + 6})) : []);
    const hits = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    context.save();
    context.font = "12px " + Chart.defaults.font.family;
    context.fillStyle = "#e8e8e8";
    chart.getDatasetMeta(index).data.forEach((point, i) => {
      const text = nameOf(chart.data.datasets[index].data[i].row);
      const width = context.measureText(text).width;
      const boxAt = ([x, y]) => ({left: point.x + x, right: point.x + x + width, top: point.y + y - 11, bottom: point.y + y + 3});
      const places = [[10, -5], [10, 4], [-10 - width, 15], [10, 15], [-10 - width, 4], [-width / 2, 22], [-width / 2, -12], [14, -22], [14, 30]];
      const box = places.map(boxAt).find(b => b.left > area.left + 2 && b.right < area.right - 2 &&
          b.top > area.top && b.bottom < area.bottom - 2 && !taken.some(t => hits(b, t)));
      if (!box) return;
      taken.push(box);
      context.fillText(text, box.left, box.bottom - 3);
    });
    context.restore();
  }};

function tooltipLines(row) {
  const lines = [`${figure(row.cpu_ms_per_megapixel)} ms CPU, ${figure(row.wall_ms_per_megapixel)} ms by the clock, per megapixel`,
                 `${row.samples_per_pixel} samples per pixel`];
  for (const part of partsOf(state.product))
    lines.push(`${figure(row.errors[state.product][part])} from ${kPartNames[part]}`);
  return lines;
}

const chart = new Chart(by("chart"), {
  type: "scatter",
  data: {datasets: []},
  options: {
    interaction: {mode: "nearest", intersect: true},
    onClick: (event, found) => { if (found.length) show(found[0].element.$context.raw.row); },
    plugins: {
      legend: {position: "bottom", labels: {usePointStyle: true, padding: 14, color: "#d8d8d8"}},
      tooltip: {
        backgroundColor: "#101012", borderColor: "#55555a", borderWidth: 1, padding: 10, displayColors: false,
        filter: item => Boolean(item.dataset.method),
        callbacks: {title: items => items.length ? nameOf(items[0].raw.row) : "",
                    label: item => tooltipLines(item.raw.row)}}}},
  plugins: [frontNames]});

function drawChart() {
  const rows = rowsShown().filter(row => errorOf(row) > 0);
  const point = row => ({x: timeOf(row), y: errorOf(row), row});
  const sets = methods.map(method => ({
    label: method, method, data: rows.filter(row => row.method === method).map(point),
    backgroundColor: color(method), borderColor: color(method), pointStyle: kShapes[method] || "circle",
    radius: 6, hoverRadius: 9, borderWidth: method === "trace" ? 2 : 0}));
  sets.push({label: "Pareto front", type: "line", data: front().filter(row => errorOf(row) > 0).map(point),
             borderColor: "#ffffff90", borderWidth: 1.5, borderDash: [6, 4], pointRadius: 0,
             pointHoverRadius: 0, pointHitRadius: 0, pointStyle: "line", order: 10});
  chart.data.datasets = sets.filter(set => set.data.length > 0);
  if (rows.length > 0) {
    const relative = bench.metrics[state.product] === "rmse" ? "RMSE" : "relative RMSE";
    chart.options.scales = {
      x: logAxis((state.clock === "cpu" ? "CPU" : "wall") + " time, ms per megapixel", rows.map(timeOf)),
      y: logAxis(`${relative} of ${state.product} from ${kPartNames[state.part]}`, rows.map(errorOf))};
  }
  chart.update();
}

// --- Which setting ---

function drawFront() {
  by("front").replaceChildren();
  for (const row of front()) {
    const item = element("li", undefined, by("front"));
    const name = element("div", undefined, item);
    element("i", "", name).className = "swatch";
    name.firstChild.style.background = color(row.method);
    name.append(nameOf(row));
    element("span", `${figure(timeOf(row))} ms   ${figure(errorOf(row))}`, item);
    item.onclick = () => { by("want").value = Number(errorOf(row).toPrecision(3)) ; advise(errorOf(row)); show(row); };
  }
}

function advise(wanted) {
  const good = front().find(row => errorOf(row) <= wanted);
  const row = good || front().at(-1);
  by("answer").replaceChildren();
  by("command").textContent = row ? row.command : "";
  if (!row) return;
  if (!good) by("answer").append("None has that. The best is ");
  element("b", nameOf(row), by("answer"));
  by("answer").append(`: error ${figure(errorOf(row))}, ${figure(timeOf(row))} ms per megapixel.`);
}

by("want").oninput = () => advise(Number(by("want").value));
by("copy").onclick = () => navigator.clipboard.writeText(by("command").textContent);

// --- Side by side ---

/// Blue where it is too dark, orange where it is too bright, and the more so the lighter.
const kRamp = Array.from({length: 256}, (_, level) => {
  const error = (level - 127.5) / 127.5, size = Math.sqrt(Math.abs(error));
  const end = error < 0 ? [120, 190, 255] : [255, 186, 100];
  const middle = error < 0 ? [28, 84, 190] : [190, 70, 20];
  const mix = (a, b, t) => a + (b - a) * t;
  return [0, 1, 2].map(c => size < 0.6 ? mix(22, middle[c], size / 0.6) : mix(middle[c], end[c], (size - 0.6) / 0.4));
});

function colorize(canvas) {
  const context = canvas.getContext("2d", {willReadFrequently: true});
  const pixels = context.getImageData(0, 0, canvas.width, canvas.height);
  for (let i = 0; i < pixels.data.length; i += 4) {
    // 127 and 128 both stand for no error.
    const level = Math.abs(pixels.data[i] - 127.5) < 1 ? 127.5 : pixels.data[i];
    const [r, g, b] = level === 127.5 ? [22, 22, 22] : kRamp[level];
    pixels.data[i] = r, pixels.data[i + 1] = g, pixels.data[i + 2] = b;
  }
  context.putImageData(pixels, 0, 0);
}

async function paint(canvas, uri, isError) {
  const image = new Image();
  image.src = uri;
  canvas.wanted = uri;
  await image.decode();
  if (canvas.wanted !== uri) return;  // another picture was chosen in the meantime
  canvas.width = image.naturalWidth, canvas.height = image.naturalHeight;
  canvas.getContext("2d", {willReadFrequently: true}).drawImage(image, 0, 0);
  if (isError) colorize(canvas);
}

/// The pictures that can be shown: references have no map of their own error.
const entries = () => bench.pictures.filter(
    p => p.pictures[state.product] && p.pictures[state.product][state.view]);
/// Names of what stands on the left and the right of each view.
const choices = {error: {}, picture: {}};

function drawChoices() {
  const all = entries(), chosen = choices[state.view];
  const byName = name => all.find(p => p.name === name);
  const standardOf = method => all.find(
      p => p.row !== undefined && bench.rows[p.row].standard && (!method || bench.rows[p.row].method === method));
  const reference = all.find(p => p.row === undefined);
  const left = byName(chosen.left) || standardOf() || all[0];
  const right = byName(chosen.right) || reference || standardOf("ssdo") || all.at(-1);
  if (!left) return;
  chosen.left = left.name, chosen.right = right.name;
  for (const [side, entry] of [["left", left], ["right", right]]) {
    by(side).replaceChildren();
    for (const p of all) element("option", p.name, by(side)).value = p.name;
    by(side).value = entry.name;
    by(side + "-name").textContent = entry.name;
    paint(by(side + "-picture"), entry.pictures[state.product][state.view], state.view === "error");
  }
  for (const view of ["error", "picture"]) by("view-" + view).className = view === state.view ? "on" : "";
  by("scale").style.visibility = state.view === "error" ? "visible" : "hidden";
}

function drawGallery() {
  by("gallery").replaceChildren();
  for (const p of entries()) {
    const tile = element("figure", undefined, by("gallery"));
    paint(element("canvas", undefined, tile), p.pictures[state.product][state.view], state.view === "error");
    const caption = element("figcaption", p.name, tile);
    if (p.row !== undefined) element("b", figure(errorOf(bench.rows[p.row])), caption);
    tile.onclick = () => { choices[state.view].right = p.name; drawChoices(); };
  }
}

function drawScale() {
  const context = by("scale-bar").getContext("2d");
  kRamp.forEach((c, level) => { context.fillStyle = `rgb(${c.join()})`; context.fillRect(level, 0, 1, 1); });
  const end = figure(bench.error_scale[state.product]);
  const from = bench.truths[state.product] ? "truth" : "trace";
  by("scale-low").textContent = `darker than ${from} by ${end}`;
  by("scale-high").textContent = `brighter by ${end}`;
}

function wipe(percent) {
  by("left-picture").style.clipPath = `inset(0 ${100 - percent}% 0 0)`;
  by("divider").style.left = percent + "%";
}

/// A row that has been clicked becomes the left picture, where there is one of it.
function show(row) {
  const entry = bench.pictures.find(p => p.row !== undefined && bench.rows[p.row] === row);
  if (!entry || !entry.pictures[state.product]) return;
  choices[state.view].left = entry.name;
  drawChoices();
}

by("wipe").oninput = () => wipe(Number(by("wipe").value));
by("viewer").onpointerdown = event => by("viewer").setPointerCapture(event.pointerId);
by("viewer").onpointermove = by("viewer").onpointerup = event => {
  if (!by("viewer").hasPointerCapture(event.pointerId)) return;
  const box = by("viewer").getBoundingClientRect();
  by("wipe").value = 100 * (event.clientX - box.left) / box.width;
  wipe(Number(by("wipe").value));
};
for (const side of ["left", "right"])
  by(side).onchange = () => { choices[state.view][side] = by(side).value; drawChoices(); };
for (const view of ["error", "picture"])
  by("view-" + view).onclick = () => { state.view = view; drawChoices(); drawGallery(); };

// --- Bars ---

const barOptions = (title, stacked) => ({
  indexAxis: "y",
  scales: {x: {stacked, title: {display: true, text: title}}, y: {stacked, grid: {display: false}}},
  plugins: {legend: {position: "bottom", labels: {boxWidth: 12}},
            tooltip: {callbacks: {label: item => `${item.dataset.label}: ${figure(item.raw)}`}}}});

const split = new Chart(by("split"), {type: "bar", data: {}, options: barOptions("error", false)});
const stages = new Chart(by("stages"), {type: "bar", data: {}, options: barOptions("ms", true)});

function drawSplit() {
  const rows = bench.rows.filter(row => row.standard && row.errors[state.product]);
  const kPartColors = {noise: "#8a8a90", approximation: "#6fb7ff", model: "#ffb347"};
  split.data = {labels: rows.map(row => row.method), datasets: partsOf(state.product).reverse().map(part => ({
    label: "from " + kPartNames[part], backgroundColor: kPartColors[part],
    data: rows.map(row => row.errors[state.product][part])}))};
  split.update();
}

function drawStages() {
  const whole = row => row.estimate.wall_ms + row.filter.wall_ms;
  const standard = bench.rows.filter(row => row.standard);
  const median = standard.map(whole).sort((a, b) => a - b)[Math.floor(standard.length / 2)];
  const common = bench.stages_ms.read + bench.stages_ms.prepare + bench.stages_ms.write;
  // One bar of ten seconds would leave nothing to see of the others.
  const fits = row => whole(row) <= 5 * (median + common);
  const rows = standard.filter(fits);
  const same = stage => rows.map(() => bench.stages_ms[stage]);
  stages.data = {labels: rows.map(row => row.method), datasets: [
    {label: "read", backgroundColor: "#55606e", data: same("read")},
    {label: "prepare", backgroundColor: "#7b8794", data: same("prepare")},
    {label: "estimate", backgroundColor: "#ffb347", data: rows.map(row => row.estimate.wall_ms)},
    {label: "filter", backgroundColor: "#67c98b", data: rows.map(row => row.filter.wall_ms)},
    {label: "write", backgroundColor: "#9a8cff", data: same("write")}]};
  stages.update();
  by("stages-note").textContent = standard.filter(row => !fits(row)).map(
      row => `Not drawn: ${row.method}, ${(whole(row) / 1000).toFixed(1)} s.`).join(" ");
}

// --- Table, plan, machine ---

function drawTable() {
  const table = by("table"), onFront = new Set(front());
  table.replaceChildren();
  const head = element("tr", undefined, element("thead", undefined, table));
  for (const text of ["method and setting", "samples", "CPU ms / MP", "wall ms / MP"]) element("th", text, head);
  for (const product of bench.products)
    for (const part of [...partsOf(product)].reverse()) element("th", `${product} ${part}`, head);
  const body = element("tbody", undefined, table);
  const errors = (tr, of, marked) => {
    for (const product of bench.products) {
      for (const part of [...partsOf(product)].reverse()) {
        const cell = element("td", figure(of[product] && of[product][part]), tr);
        if (marked && product === state.product && part === state.part) cell.className = "best";
      }
    }
  };
  for (const method of methods) {
    for (const row of bench.rows.filter(r => r.method === method)) {
      const tr = element("tr", undefined, body), name = element("td", undefined, tr);
      element("i", "", name).className = "swatch";
      name.firstChild.style.background = color(method);
      name.append(nameOf(row));
      element("td", row.samples_per_pixel, tr);
      element("td", figure(row.cpu_ms_per_megapixel), tr);
      element("td", figure(row.wall_ms_per_megapixel), tr);
      errors(tr, row.errors, onFront.has(row));
    }
    for (const limit of bench.limits.filter(l => l.method === method)) {
      const tr = element("tr", undefined, body);
      tr.className = "limit";
      element("td", `${method} limit: ${limit.setting}` + (limit.seeds > 1 ? `, ${limit.seeds} seeds` : ""), tr);
      for (let i = 0; i < 3; ++i) element("td", "", tr);
      errors(tr, limit.errors, false);
    }
  }
}

function define(list, term, text) {
  element("dt", term, by(list));
  element("dd", text, by(list));
}

function drawFacts() {
  const {frame, machine} = bench, plan = frame.plan;
  document.title = "ssdo bench: " + bench.input;
  by("input").textContent = bench.input;
  by("summary").textContent =
      `${frame.width} × ${frame.height}, ${bench.surface_pixels} of ${bench.pixels} pixels show surfaces · ` +
      `${machine.threads} thread(s) of ${machine.processor} (${machine.isa}) · filter ${bench.filter} · measured in ${bench.seconds.toFixed(0)} s`;
  define("plan", "products", bench.products.join(", "));
  define("plan", "light", frame.light);
  define("plan", "camera", `${frame.camera.source}, ${frame.camera.type}`);
  for (const [product, layer] of Object.entries(bench.truths)) define("plan", "truth of " + product, layer);
  define("plan", "bounces", plan.bounces);
  for (const reason of plan.reasons) define("plan", "", reason);
  for (const warning of frame.warnings) define("plan", "warning", warning);
  define("machine", "processor", machine.processor);
  define("machine", "logical processors", machine.processors);
  define("machine", "threads used", machine.threads);
  define("machine", "instruction set", machine.isa);
  define("machine", "ssdo", bench.version);
}

function drawAll() {
  for (const button of by("products").children) button.className = button.value === state.product ? "on" : "";
  by("against").replaceChildren();
  for (const part of partsOf(state.product)) element("option", kPartNames[part], by("against")).value = part;
  if (!partsOf(state.product).includes(state.part)) state.part = partsOf(state.product)[0];
  by("against").value = state.part;
  drawChart(), drawFront(), drawTable(), drawSplit(), drawScale(), drawChoices(), drawGallery();
  const best = front().at(-1);
  by("want").value = best ? Number((1.2 * errorOf(best)).toPrecision(2)) : "";
  advise(Number(by("want").value));
}

for (const product of bench.products) {
  const button = element("button", product, by("products"));
  button.value = product;
  button.onclick = () => { state.product = product; state.part = ""; drawAll(); };
}
by("against").onchange = () => { state.part = by("against").value; drawAll(); };
by("clock").onchange = () => { state.clock = by("clock").value; drawAll(); };
drawFacts();
drawStages();
wipe(50);
drawAll();
