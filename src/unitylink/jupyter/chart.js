// SPDX-License-Identifier: BSD-3-Clause
// The live chart of a notebook: one band for each value, each with its own scale. Python sends samples as float64.

const BAND = 64; // pixels
const LABEL = 190;
const MOST = 200000; // samples of one value that are kept

export class Series {
  constructor() {
    this.times = [];
    this.values = [];
  }

  // Append samples, and forget those before `begin`. A time that goes back starts anew: the board was restarted.
  add(times, values, begin) {
    if (times.length && this.times.length && times[0] < this.times[this.times.length - 1]) {
      this.times = [];
      this.values = [];
    }
    for (let i = 0; i < times.length; i++) {
      this.times.push(times[i]);
      this.values.push(values[i]);
    }
    let old = Math.max(0, this.times.length - MOST);
    while (old < this.times.length - 1 && this.times[old + 1] < begin) old++; // one is kept for the left edge
    if (old > this.times.length / 4) {
      this.times.splice(0, old);
      this.values.splice(0, old);
    }
  }
}

// Take a message: for each series its number, its count of samples, their times, their values.
export function take(all, numbers, window) {
  let newest = -Infinity;
  for (let at = 0; at < numbers.length; ) {
    const series = all[numbers[at]];
    const count = numbers[at + 1];
    const times = numbers.slice(at + 2, at + 2 + count);
    const values = numbers.slice(at + 2 + count, at + 2 + 2 * count);
    at += 2 + 2 * count;
    series.add(times, values, times[times.length - 1] - window);
    newest = Math.max(newest, times[times.length - 1]);
  }
  return newest;
}

// The least and the greatest value of each column of pixels, or null. A value is held until its newest sample.
export function columns(series, begin, step, count) {
  const spans = new Array(count).fill(null);
  let before = null;
  let drawn = 0;
  for (let i = 0; i < series.times.length; i++) {
    const value = series.values[i];
    const column = Math.floor((series.times[i] - begin) / step);
    if (column >= count) break;
    if (!Number.isFinite(value)) continue;
    if (column >= 0) {
      if (before !== null) for (; drawn < column; drawn++) spans[drawn] = spans[drawn] || [before, before];
      const span = spans[column] || (before === null ? [value, value] : [before, before]);
      spans[column] = [Math.min(span[0], value), Math.max(span[1], value)];
      drawn = column;
    }
    before = value;
  }
  return spans;
}

export function shown(facts, value) {
  const name = facts.members[String(value)];
  const text = name === undefined ? String(Number(value.toPrecision(6))) : name;
  return facts.unit ? `${text} ${facts.unit}` : text;
}

function last(facts, series) {
  return series.values.length ? shown(facts, series.values[series.values.length - 1]) : 'no value yet';
}

function drawBand(context, facts, series, top, width, begin, window) {
  const room = Math.max(1, width - LABEL);
  const step = window / room;
  const spans = columns(series, begin + step / 2, step, room); // the newest sample is in the last column
  const ends = spans.filter((span) => span !== null);
  const least = Math.min(...ends.map((span) => span[0]));
  const greatest = Math.max(...ends.map((span) => span[1]));
  context.font = '600 13px sans-serif';
  context.fillText(facts.name, 0, top + 16, LABEL - 10);
  context.font = '13px sans-serif';
  context.fillText(last(facts, series), 0, top + 34, LABEL - 10);
  if (!ends.length) return;
  context.fillText(`${shown(facts, least)} to ${shown(facts, greatest)}`, 0, top + 52, LABEL - 10);
  const height = BAND - 12;
  const scale = greatest > least ? height / (greatest - least) : 0;
  const y = (value) => top + 6 + (scale ? (greatest - value) * scale : height / 2);
  spans.forEach((span, column) => {
    if (span) context.fillRect(LABEL + column, y(span[1]) - 0.75, 1.5, y(span[0]) - y(span[1]) + 1.5);
  });
}

function render({ model, el }) {
  const facts = model.get('series');
  const all = facts.map(() => new Series());
  const canvas = document.createElement('canvas');
  const note = document.createElement('div');
  canvas.setAttribute('role', 'img');
  el.append(canvas, note);
  let newest = -Infinity;
  let asked = 0;

  function draw() {
    asked = 0;
    const ratio = globalThis.devicePixelRatio || 1;
    const width = Math.max(LABEL + 50, el.clientWidth || 640);
    canvas.width = width * ratio;
    canvas.height = BAND * facts.length * ratio;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${BAND * facts.length}px`;
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    context.fillStyle = getComputedStyle(el).color;
    const window = model.get('window_s');
    facts.forEach((one, number) => drawBand(context, one, all[number], BAND * number, width, newest - window, window));
    note.textContent = model.get('ended') || `the last ${window} s`;
    canvas.setAttribute('aria-label', facts.map((one, number) => `${one.name}: ${last(one, all[number])}`).join(', '));
  }

  function later() {
    if (!asked) asked = requestAnimationFrame(draw);
  }

  function hear(_, buffers) {
    const bytes = buffers[0];
    const copy = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    newest = take(all, new Float64Array(copy), model.get('window_s'));
    later();
  }

  model.on('msg:custom', hear);
  model.on('change:ended', later);
  later();
  return () => {
    model.off('msg:custom', hear);
    model.off('change:ended', later);
    cancelAnimationFrame(asked);
  };
}

export default { render };
