// SPDX-License-Identifier: BSD-3-Clause
// The charts. Live, they roll. Frozen, they can be moved and zoomed, and get each range as finely as it is kept.
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { aligned, type Drawn, stepFor } from "./chart_data";
import { beat, drawn, follow, items, now_s, range, wall_s } from "./connection";
import { active, addChart, change, charts, type Layout, removeChart, toggle, WINDOWS_S } from "./layout";
import { tell } from "./messages";
import type { Item } from "./model";

const HEIGHT = 230;
const SLACK_S = 0.1; // a live chart ends so much before now, because the newest samples are on their way
const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3]];
const dark = matchMedia("(prefers-color-scheme: dark)");
const css = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

interface Range {
  begin_s: number;
  end_s: number;
}

export function Charts() {
  return (
    <div class="charts">
      {charts.value.map((one) => <Chart key={one.id} layout={one} />)}
      <button type="button" class="add" onClick={() => addChart()}>add a chart</button>
    </div>
  );
}

function Chart({ layout }: { layout: Layout }) {
  const { id, paths, window_s } = layout;
  const place = useRef<HTMLDivElement>(null);
  const [frozen, setFrozen] = useState<Range | null>(null);
  const [table, setTable] = useState(false);
  const [width, setWidth] = useState(0);
  const [scheme, setScheme] = useState(dark.matches);
  const latest = useRef<Drawn[]>([]);
  const shown = paths.map((path) => items.find((item) => item.facts.path === path)).filter((one) => !!one);
  const key = shown.map((item) => item.number).join();

  useEffect(() => {
    const watch = new ResizeObserver(([entry]) => setWidth(Math.floor(entry?.contentRect.width ?? 0)));
    if (place.current) watch.observe(place.current);
    const flip = () => setScheme(dark.matches);
    dark.addEventListener("change", flip);
    return () => {
      watch.disconnect();
      dark.removeEventListener("change", flip);
    };
  }, []);

  useEffect(() => {
    if (!place.current || width < 50 || !shown.length) return;
    const plot = new uPlot(options(shown, width, setFrozen, () => setFrozen(null)), [[]], place.current);
    place.current.querySelector("canvas")?.setAttribute("aria-hidden", "true");
    const draw = (series: Drawn[], begin_s: number, end_s: number) => {
      latest.current = series;
      plot.batch(() => {
        plot.setData(aligned(series, begin_s, end_s, wall_s), false);
        plot.setScale("x", { min: wall_s(begin_s), max: wall_s(end_s) });
        for (const name of Object.keys(plot.scales)) if (name !== "x") plot.setScale(name, limits(plot, name));
      });
    };
    if (frozen) {
      let gone = false;
      const step_s = stepFor(frozen.end_s - frozen.begin_s, width);
      range(shown.map((item) => item.number), step_s, frozen.begin_s, frozen.end_s).then((found) => {
        if (!gone) draw(shown.map((item) => ({ item, series: found.get(item.number) })), frozen.begin_s, frozen.end_s);
      }, (error: Error) => tell(error.message));
      return () => {
        gone = true;
        plot.destroy();
      };
    }
    const step_s = stepFor(window_s, width);
    const followed = shown.map((item) => ({ item, ...follow(item.number, step_s, now_s() - window_s - step_s) }));
    let due = false;
    const redraw = () => {
      if (due) return;
      due = true;
      requestAnimationFrame(() => {
        due = false;
        const end_s = now_s() - SLACK_S;
        for (const { series } of followed) series.trim(end_s - window_s - 2 * step_s);
        draw(followed, end_s - window_s, end_s);
      });
    };
    drawn.add(redraw);
    return () => {
      drawn.delete(redraw);
      for (const { leave } of followed) leave();
      plot.destroy();
    };
  }, [key, window_s, width, frozen?.begin_s, frozen?.end_s, scheme]);

  const view = (): Range => frozen ?? { begin_s: now_s() - SLACK_S - window_s, end_s: now_s() - SLACK_S };
  const move = (parts: number) => {
    const { begin_s, end_s } = view();
    const by = (end_s - begin_s) * parts;
    setFrozen({ begin_s: begin_s + by, end_s: end_s + by });
  };
  const zoom = (factor: number) => {
    const { begin_s, end_s } = view();
    const middle = (begin_s + end_s) / 2;
    const half = Math.max(0.002, ((end_s - begin_s) * factor) / 2);
    setFrozen({ begin_s: middle - half, end_s: middle + half });
  };
  const keys: Record<string, () => void> = {
    ArrowLeft: () => move(-0.25),
    ArrowRight: () => move(0.25),
    "+": () => zoom(0.5),
    "-": () => zoom(2),
    " ": () => setFrozen(frozen ? null : view()),
  };
  const press = (event: KeyboardEvent) => {
    const action = event.target === event.currentTarget ? keys[event.key] : undefined;
    if (action) event.preventDefault();
    action?.();
  };
  const drop = (event: DragEvent) => {
    event.preventDefault();
    const path = event.dataTransfer?.getData("text/plain") ?? "";
    if (items.some((item) => item.facts.path === path) && !paths.includes(path)) toggle(path, id);
  };
  const csv = () => {
    const { begin_s, end_s } = view();
    const wanted = shown.map((item) => `item=${encodeURIComponent(item.facts.path)}`).join("&");
    location.assign(`csv?${wanted}&begin_s=${begin_s}&end_s=${end_s}`);
  };
  const title = shown.length ? shown.map((item) => item.facts.path).join(", ") : "an empty chart";
  return (
    <section class={`chart card ${active.value === id ? "active" : ""}`} aria-label={`chart of ${title}`}
      onFocusIn={() => (active.value = id)} onPointerDown={() => (active.value = id)}
      onDragOver={(event) => event.preventDefault()} onDrop={drop}>
      <ul class="legend">
        {shown.map((item, index) => (
          <Key key={item.number} item={item} index={index} onRemove={() => toggle(item.facts.path, id)} />
        ))}
        {!shown.length && <li class="quiet">choose values with the button of a row, or drag their names here</li>}
      </ul>
      <div ref={place} class="plot" tabIndex={0} role="img" onKeyDown={press}
        aria-label={`${title}: arrows move, plus and minus zoom, space freezes; the table has the numbers`} />
      <div class="tools">
        <button type="button" aria-pressed={!!frozen} onClick={() => setFrozen(frozen ? null : view())}>
          {frozen ? "live" : "freeze"}
        </button>
        <button type="button" aria-label="earlier" onClick={() => move(-0.5)}>◀</button>
        <button type="button" aria-label="later" onClick={() => move(0.5)}>▶</button>
        <button type="button" aria-label="zoom in" onClick={() => zoom(0.5)}>+</button>
        <button type="button" aria-label="zoom out" onClick={() => zoom(2)}>−</button>
        <select aria-label="length of the chart" value={window_s}
          onChange={(event) => {
            setFrozen(null);
            change(id, { window_s: Number(event.currentTarget.value) });
          }}>
          {WINDOWS_S.map((one) => <option key={one} value={one}>{one < 60 ? `${one} s` : `${one / 60} min`}</option>)}
        </select>
        <button type="button" onClick={csv} disabled={!shown.length}>CSV</button>
        <button type="button" aria-pressed={table} onClick={() => setTable(!table)}>table</button>
        <button type="button" aria-label={`remove the chart of ${title}`} onClick={() => removeChart(id)}>×</button>
      </div>
      {table && <Numbers shown={shown} latest={latest.current} />}
    </section>
  );
}

function Key({ item, index, onRemove }: { item: Item; index: number; onRemove: () => void }) {
  const { path, unit } = item.facts;
  return (
    <li class={item.age.value ? "stale" : ""}>
      <svg viewBox="0 0 24 8" aria-hidden="true">
        <line x1="0" y1="4" x2="24" y2="4" style={`stroke:var(--line${index % 8})`}
          stroke-dasharray={DASHES[Math.floor(index / 2) % 4]?.join(" ")} />
      </svg>
      {path} <b>{item.shown}</b> <span class="unit">{unit}</span>
      <button type="button" aria-label={`take ${path} out of the chart`} onClick={onRemove}>×</button>
    </li>
  );
}

/** What the chart shows, in numbers. */
function Numbers({ shown, latest }: { shown: Item[]; latest: Drawn[] }) {
  void beat.value;
  const least = (item: Item, pick: "least" | "greatest") => {
    const series = latest.find((one) => one.item === item)?.series;
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
            <td>{item.shown} {item.facts.unit}</td>
            <td>{least(item, "least")}</td>
            <td>{least(item, "greatest")}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** The scale of a unit: values of one unit share one, and the first two units get an axis. */
const scaleOf = (item: Item): string => `y:${item.facts.unit}`;

function options(shown: Item[], width: number, onZoom: (to: Range) => void, onReset: () => void): uPlot.Options {
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
        width: 1.5,
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
function limits(plot: uPlot, name: string): { min: number; max: number } {
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
