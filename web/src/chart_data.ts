// SPDX-License-Identifier: BSD-3-Clause
// From series of buckets to the rows that uPlot draws.
import type { AlignedData } from "uplot";
import type { Item } from "./model";
import type { Series } from "./series";

const GAP_S = 1; // a longer silence of something that has a rate is a gap in its line
const PIXELS = 2; // of a bucket; its least and its greatest value are one beside the other

export interface Drawn {
  item: Item;
  series: Series | undefined;
}

/** The step of the buckets of a chart: 1, 2 or 5 of a power of ten, so that many charts share one. */
export function stepFor(window_s: number, width: number): number {
  const wanted = (window_s * PIXELS) / Math.max(100, width);
  const power = 10 ** Math.floor(Math.log10(wanted));
  const step = [1, 2, 5, 10].find((one) => one * power >= wanted * 0.999) ?? 10;
  return Number((step * power).toPrecision(1));
}

/** Two points for each bucket, its least and its greatest value. All series have the same step. */
export function aligned(
  drawn: Drawn[], begin_s: number, end_s: number, wall_s: (time_s: number) => number,
): AlignedData {
  const step_s = drawn.find((one) => one.series)?.series?.step_s ?? 1;
  const first = Math.floor(begin_s / step_s);
  const count = Math.max(0, Math.ceil(end_s / step_s) - first + 1);
  const times = new Array<number>(2 * count);
  for (let at = 0; at < count; at++) {
    times[2 * at] = wall_s((first + at + 0.25) * step_s);
    times[2 * at + 1] = wall_s((first + at + 0.75) * step_s);
  }
  const rows = drawn.map(({ item, series }) => {
    const row = new Array<number | null | undefined>(2 * count).fill(undefined);
    if (!series) return row;
    const gap = item.rate_hz > 0 ? Math.max(GAP_S, 5 / item.rate_hz) / step_s : Infinity;
    let before = -1;
    let middle = -Infinity;
    for (let at = series.from(begin_s); at < series.numbers.length; at++) {
      const slot = (series.numbers[at] ?? 0) - first;
      if (slot >= count) break;
      if (before >= 0 && slot - before > gap) row[2 * before + 2] = null;
      const low = series.least[at] ?? NaN;
      const high = series.greatest[at] ?? NaN;
      const falls = low + high < middle; // so a line that falls has no teeth
      row[2 * slot] = falls ? high : low;
      row[2 * slot + 1] = falls ? low : high;
      middle = low + high;
      before = slot;
    }
    return row;
  });
  return [times, ...rows] as AlignedData;
}
