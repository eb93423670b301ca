// SPDX-License-Identifier: Apache-2.0
// Bars, the table, plan and machine; then all is drawn for the first time.

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
  const {read, known, prepare, write} = bench.stages_ms;
  const common = read + known + prepare + write;
  // One bar of ten seconds would leave nothing to see of the others.
  const fits = row => whole(row) <= 5 * (median + common);
  const rows = standard.filter(fits);
  const same = stage => rows.map(() => bench.stages_ms[stage]);
  stages.data = {labels: rows.map(row => row.method), datasets: [
    {label: "read", backgroundColor: "#55606e", data: same("read")},
    {label: "known", backgroundColor: "#66788a", data: same("known")},
    {label: "prepare", backgroundColor: "#7b8794", data: same("prepare")},
    {label: "estimate", backgroundColor: "#ffb347", data: rows.map(row => row.estimate.wall_ms)},
    {label: "filter", backgroundColor: "#67c98b", data: rows.map(row => row.filter.wall_ms)},
    {label: "write", backgroundColor: "#9a8cff", data: same("write")}]};
  stages.update();
  by("stages-note").textContent = standard.filter(row => !fits(row)).map(
      row => `Not drawn: ${row.method}, ${(whole(row) / 1000).toFixed(1)} s.`).join(" ");
}

function drawTable() {
  const table = by("table"), onFront = new Set(front());
  table.replaceChildren();
  const head = element("thead", undefined, table);
  const groups = element("tr", undefined, head), names = element("tr", undefined, head);
  element("th", "", groups).colSpan = 4;
  for (const text of ["method and setting", "samples", "CPU ms / MP", "wall ms / MP"]) element("th", text, names);
  for (const product of bench.products) {
    const group = element("th", `${product}, ${metricOf(product)}`, groups);
    group.colSpan = partsOf(product).length;
    group.className = "group-start";
    for (const part of [...partsOf(product)].reverse()) element("th", part, names);
  }
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
  defineMachine();
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
