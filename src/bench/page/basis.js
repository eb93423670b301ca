// SPDX-License-Identifier: Apache-2.0
// What all pages of `ssdo bench` use: everything comes from the JSON block beside them, which is what
// `--report FILE.json` writes.
"use strict";

const bench = JSON.parse(document.getElementById("data").textContent);
const by = id => document.getElementById(id);

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

Chart.defaults.color = "#a8a8ab";
Chart.defaults.borderColor = "#38383b";
Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
Chart.defaults.font.size = 13;
Chart.defaults.animation = false;
Chart.defaults.maintainAspectRatio = false;

/// Round numbers between two values: 1, 2 and 5 times powers of ten, and more within a decade.
function logTicks(low, high) {
  const ticks = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
    for (const m of high / low < 10 ? [1, 1.5, 2, 3, 4, 5, 7] : [1, 2, 5]) {
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

function define(list, term, text) {
  element("dt", term, by(list));
  element("dd", text, by(list));
}

function defineMachine() {
  const {machine} = bench;
  define("machine", "processor", machine.processor);
  define("machine", "logical processors", machine.processors);
  define("machine", "threads used", machine.threads);
  define("machine", "instruction set", machine.isa);
  define("machine", "ssdo", bench.version);
}
