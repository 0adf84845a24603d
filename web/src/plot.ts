// SPDX-License-Identifier: BSD-3-Clause
// How uPlot draws a chart: axes, colours, limits.
import type uPlot from "uplot";
import type { Item } from "./model";

const HEIGHT = 230;
// On a screen of coarse pixels, a line of one pixel: without a graphics card, a wider one takes five times as long.
const LINE = devicePixelRatio > 1 ? 1.5 : 1;
export const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3]];
const css = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export interface Range {
  begin_s: number;
  end_s: number;
}

/** The scale of a unit: values of one unit share one, and the first two units get an axis. */
const scaleOf = (item: Item): string => `y:${item.facts.unit}`;

/** How a chart looks. `wall_s(0)` is what the marks of time begin from, in s since 1970. */
export function options(
  shown: Item[], width: number, wall_s: (time_s: number) => number, onZoom: (to: Range) => void, onReset: () => void,
): uPlot.Options {
  const text = css("--text");
  const grid = { stroke: css("--grid"), width: 1 };
  const scales = [...new Set(shown.map(scaleOf))];
  const side = (name: string, index: number): uPlot.Axis => ({
    scale: name,
    side: index ? 1 : 3,
    stroke: text,
    grid: index ? { show: false } : grid,
    ticks: grid,
    size: 58,
    label: name.slice(2),
    labelSize: name.length > 2 ? 18 : 0,
    labelFont: "12px system-ui",
    font: "12px system-ui",
  });
  return {
    width,
    height: HEIGHT,
    legend: { show: false },
    cursor: { drag: { x: true, y: false, setScale: false }, points: { show: false } },
    scales: {
      x: { time: false, auto: false },
      ...Object.fromEntries(scales.map((name) => [name, { auto: false }])),
    },
    axes: [
      { stroke: text, grid, ticks: grid, font: "12px system-ui", space: 90, values: (_, splits) => splits.map(clock) },
      ...scales.slice(0, 2).map(side),
    ],
    series: [
      {},
      ...shown.map((item, index): uPlot.Series => ({
        scale: scaleOf(item),
        stroke: css(`--line${index % 8}`),
        dash: DASHES[Math.floor(index / 2) % 4],
        width: LINE,
        points: { show: false },
      })),
    ],
    hooks: {
      setSelect: [(plot) => {
        if (plot.select.width < 5) return;
        const at = (x: number) => plot.posToVal(x, "x") - wall_s(0);
        onZoom({ begin_s: at(plot.select.left), end_s: at(plot.select.left + plot.select.width) });
      }],
      init: [(plot) => plot.over.addEventListener("dblclick", onReset)],
    },
  };
}

/** Limits of a scale that hold all its values, with some room. */
export function limits(plot: uPlot, name: string): { min: number; max: number } {
  let min = Infinity;
  let max = -Infinity;
  plot.series.forEach((series, index) => {
    if (series.scale !== name) return;
    for (const value of plot.data[index] ?? []) {
      if (value === null || value === undefined || !Number.isFinite(value)) continue;
      if (value < min) min = value;
      if (value > max) max = value;
    }
  });
  if (min > max) return { min: 0, max: 1 };
  const room = (max - min) * 0.05 || Math.abs(max) * 0.05 || 1;
  return { min: min - room, max: max + room };
}

/** The time of day, with as many digits as the distance of the marks needs. */
function clock(wall: number, _: number, all: number[]): string {
  const moment = new Date(wall * 1000);
  const apart_s = (all[1] ?? 0) - (all[0] ?? 0) || 1;
  const digits = apart_s >= 1 ? 0 : Math.min(3, Math.ceil(-Math.log10(apart_s)));
  const seconds = (moment.getSeconds() + moment.getMilliseconds() / 1000).toFixed(digits);
  const two = (number: number) => String(number).padStart(2, "0");
  return `${two(moment.getHours())}:${two(moment.getMinutes())}:${seconds.padStart(digits ? 3 + digits : 2, "0")}`;
}
