// SPDX-License-Identifier: BSD-3-Clause
// What a chart shows, in words and numbers: its legend, and its table.
import { beat, replay } from "./connection";
import type { Drawn } from "./chart_data";
import type { Item } from "./model";
import { DASHES } from "./plot";
import { position_s } from "./replayed";

/** What the chart has drawn, which changes without a word to the page. */
export interface Latest {
  current: Drawn[];
}

export function Key(
  { item, index, latest, onRemove }: { item: Item; index: number; latest: Latest; onRemove: () => void },
) {
  const { path, unit } = item.facts;
  const replayed = replay.value !== null;
  return (
    <li class={item.age.value && !replayed ? "stale" : ""}>
      <svg viewBox="0 0 24 8" aria-hidden="true">
        <line x1="0" y1="4" x2="24" y2="4" style={`stroke:var(--line${index % 8})`}
          stroke-dasharray={DASHES[Math.floor(index / 2) % 4]?.join(" ")} />
      </svg>
      {path} <b>{replayed ? past(item, latest) : item.shown}</b> <span class="unit">{unit}</span>
      <button type="button" aria-label={`take ${path} out of the chart`} onClick={onRemove}>×</button>
    </li>
  );
}

/** The value of an item at the place of the replay. */
function past(item: Item, latest: Latest): string {
  void beat.value;
  const value = latest.current.find((one) => one.item === item)?.series?.before(position_s.peek());
  return value === undefined ? "–" : item.format(value);
}

/** What the chart shows, in numbers. */
export function Numbers({ shown, latest }: { shown: Item[]; latest: Latest }) {
  void beat.value;
  const least = (item: Item, pick: "least" | "greatest") => {
    const series = latest.current.find((one) => one.item === item)?.series;
    if (!series?.numbers.length) return "–";
    const found = series[pick].reduce((a, b) => (pick === "least" ? Math.min(a, b) : Math.max(a, b)));
    return item.format(found);
  };
  return (
    <table class="numbers">
      <thead>
        <tr>{["name", "now", "least", "greatest"].map((one) => <th key={one} scope="col">{one}</th>)}</tr>
      </thead>
      <tbody>
        {shown.map((item) => (
          <tr key={item.number}>
            <th scope="row">{item.facts.path}</th>
            <td>{replay.value ? past(item, latest) : item.shown} {item.facts.unit}</td>
            <td>{least(item, "least")}</td>
            <td>{least(item, "greatest")}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
