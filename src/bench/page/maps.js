// SPDX-License-Identifier: Apache-2.0
// The maps of errors and the pictures, with the wipe.

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
