// SPDX-License-Identifier: Apache-2.0
// The page of `ssdo bench` for a frame: the chart of speed and error, and which setting to take.
"use strict";

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
const metricOf = product => bench.metrics[product] === "rmse" ? "RMSE" : "relative RMSE";
const rowsShown = () => bench.rows.filter(row => errorOf(row) !== null);

/// The rows of which no other is both as cheap and as good, cheapest first: as pareto_front() does
/// it, but for the clock and the reference that are chosen here.
function front() {
  const sorted = rowsShown().sort((a, b) => timeOf(a) - timeOf(b) || errorOf(a) - errorOf(b));
  let least = Infinity;
  return sorted.filter(row => errorOf(row) < least && ((least = errorOf(row)), true));
}

// --- Speed and error ---

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
    chart.options.scales = {
      x: logAxis((state.clock === "cpu" ? "CPU" : "wall") + " time, ms per megapixel", rows.map(timeOf)),
      y: logAxis(`${metricOf(state.product)} of ${state.product} from ${kPartNames[state.part]}`, rows.map(errorOf))};
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
  by("command").replaceChildren();
  // Lines break between words, and not after the dashes of an option.
  for (const word of row ? row.command.split(" ") : []) {
    if (by("command").firstChild) by("command").append(" ");
    element("span", word, by("command"));
  }
  if (!row) return;
  if (!good) by("answer").append("None has that. The best is ");
  element("b", nameOf(row), by("answer"));
  by("answer").append(`: error ${figure(errorOf(row))}, ${figure(timeOf(row))} ms per megapixel.`);
}

by("want").oninput = () => advise(Number(by("want").value));
by("copy").onclick = () => navigator.clipboard.writeText(by("command").textContent);
