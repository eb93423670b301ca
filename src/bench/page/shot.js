// SPDX-License-Identifier: Apache-2.0
// The page of `ssdo bench` for a sequence: flicker and error of ways to take its frames together.
"use strict";

const kKinds = [
  {label: "each frame alone", holds: row => !row.temporal && row.frames_around === 0, color: "#f2f2f2", shape: "rect"},
  {label: "causal filter", holds: row => row.temporal, color: "#6fb7ff", shape: "triangle"},
  {label: "frames before and after", holds: row => row.frames_around > 0, color: "#ffb347", shape: "circle"}];

/// What is looked at: a product and a clock.
const state = {product: bench.products[0], clock: "cpu"};

const timeOf = row => row[state.clock + "_s_per_frame"];
const valueOf = (row, what) => row.products[state.product][what];
const isRelative = product => bench.metrics[product] !== "rms";

/// Writes the name of a setting beside its point.
const names = {
  id: "names",
  afterDatasetsDraw(chart) {
    const {ctx: context, chartArea: area} = chart;
    context.save();
    context.font = "12px " + Chart.defaults.font.family;
    context.fillStyle = "#e8e8e8";
    chart.data.datasets.forEach((set, i) => chart.getDatasetMeta(i).data.forEach((point, k) => {
      const text = set.data[k].row.setting, width = context.measureText(text).width;
      const left = point.x + 10 + width > area.right ? point.x - 10 - width : point.x + 10;
      context.fillText(text, left, point.y + (k % 2 === 0 ? -6 : 16));  // the next one apart
    }));
    context.restore();
  }};

const plot = id => new Chart(by(id), {
  type: "scatter",
  data: {datasets: []},
  options: {
    onClick: (event, found) => { if (found.length) tell(found[0].element.$context.raw.row); },
    plugins: {
      legend: {position: "bottom", labels: {usePointStyle: true, padding: 14, color: "#d8d8d8"}},
      tooltip: {callbacks: {label: item => `${item.raw.row.setting}: ${figure(item.raw.y)}, ${figure(item.raw.x)} s a frame`}}}},
  plugins: [names]});
const plots = {flicker: plot("flicker"), error: plot("error")};

function draw(what) {
  const rows = bench.rows.filter(row => valueOf(row, what) > 0 && timeOf(row) > 0);
  plots[what].data.datasets = kKinds.map(kind => ({
    label: kind.label, backgroundColor: kind.color, borderColor: kind.color, pointStyle: kind.shape,
    radius: 6, hoverRadius: 9, data: rows.filter(kind.holds).map(row => ({x: timeOf(row), y: valueOf(row, what), row}))
  })).filter(set => set.data.length > 0);
  if (rows.length > 0) {
    const title = (isRelative(state.product) ? "relative " : "") + `${what} of ${state.product}`;
    plots[what].options.scales = {
      x: logAxis((state.clock === "cpu" ? "CPU" : "wall") + " time, s a frame", rows.map(timeOf)),
      y: logAxis(title, rows.map(row => valueOf(row, what)))};
  }
  plots[what].update();
}

function tell(row) { by("command").textContent = row.command; }

function drawTable() {
  const table = by("table");
  table.replaceChildren();
  const names = element("tr", undefined, element("thead", undefined, table));
  const figures = {flicker: "flicker", flicker_p99: "99 %", flicker_border: "border", error: "error",
                   error_near_moving: "error near what moves", flicker_of_error: "flicker of error", points: "points"};
  for (const text of ["setting", "CPU s / frame", "wall s / frame", ...Object.values(figures)]) element("th", text, names);
  const body = element("tbody", undefined, table);
  for (const row of bench.rows) {
    const tr = element("tr", undefined, body);
    element("td", row.setting, tr);
    element("td", figure(row.cpu_s_per_frame), tr);
    element("td", figure(row.wall_s_per_frame), tr);
    for (const what of Object.keys(figures))
      element("td", what === "points" ? valueOf(row, what) : figure(valueOf(row, what)), tr);
    tr.onclick = () => tell(row);
  }
}

function drawFacts() {
  const {machine, frames} = bench;
  document.title = "ssdo bench: " + bench.input;
  by("input").textContent = bench.input;
  by("summary").textContent =
      `${frames.length} frames of ${bench.width} × ${bench.height} · ${bench.method}, filter ${bench.filter} · ` +
      `${machine.threads} thread(s) of ${machine.processor} (${machine.isa}) · measured in ${bench.seconds.toFixed(0)} s`;
  define("plan", "frames", `${frames[0]} to ${frames.at(-1)}`);
  define("plan", "products", bench.products.join(", "));
  for (const [product, truth] of Object.entries(bench.truths))
    define("plan", "truth of " + product, `${truth.picture}, frames ${truth.frames.join(", ")}`);
  defineMachine();
}

function drawAll() {
  for (const button of by("products").children) button.className = button.value === state.product ? "on" : "";
  by("no-truth").textContent = bench.truths[state.product] ? "" : `No truth of ${state.product} was given.`;
  draw("flicker"), draw("error"), drawTable();
}

for (const product of bench.products) {
  const button = element("button", product, by("products"));
  button.value = product;
  button.onclick = () => { state.product = product; drawAll(); };
}
by("clock").onchange = () => { state.clock = by("clock").value; drawAll(); };
drawFacts();
drawAll();
tell(bench.rows.at(-1));
