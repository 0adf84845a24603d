// SPDX-License-Identifier: BSD-3-Clause
// A chart. Live, it rolls. Frozen, it can be moved and zoomed, and gets each range as finely as it is kept. While a
// recording is replayed, it shows that.
import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { aligned, type Drawn, stepFor } from "./chart_data";
import { Key, Numbers } from "./chart_words";
import { drawn, follow, items, now_s, range, replay, wall_s } from "./connection";
import { active, change, type Layout, removeChart, toggle, WINDOWS_S } from "./layout";
import { tell } from "./messages";
import { limits, options, type Range } from "./plot";
import { Ahead, position_s } from "./replayed";
import type { Series } from "./series";

const SLACK_S = 0.1; // a live chart ends so much before now, because the newest samples are on their way
const dark = matchMedia("(prefers-color-scheme: dark)");

export function Chart({ layout }: { layout: Layout }) {
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

  const shownReplay = replay.value;
  const replayed = shownReplay?.name ?? "";
  useEffect(() => setFrozen(null), [replayed]);

  useEffect(() => {
    if (!place.current || width < 50 || !shown.length) return;
    const wall = (time_s: number) => (shownReplay ? shownReplay.begun_s + time_s : wall_s(time_s));
    const plot = new uPlot(options(shown, width, wall, setFrozen, () => setFrozen(null)), [[]], place.current);
    place.current.querySelector("canvas")?.setAttribute("aria-hidden", "true");
    const numbers = shown.map((item) => item.number);
    const draw = (series: Drawn[], begin_s: number, end_s: number) => {
      latest.current = series;
      plot.batch(() => {
        plot.setData(aligned(series, begin_s, end_s, wall), false);
        plot.setScale("x", { min: wall(begin_s), max: wall(end_s) });
        for (const name of Object.keys(plot.scales)) if (name !== "x") plot.setScale(name, limits(plot, name));
      });
    };
    const found = (series: Map<number, Series>) => shown.map((item) => ({ item, series: series.get(item.number) }));
    const step_s = stepFor(frozen ? frozen.end_s - frozen.begin_s : window_s, width);
    const ends: (() => void)[] = [() => plot.destroy()];
    if (frozen) {
      let gone = false;
      ends.push(() => (gone = true));
      range(numbers, step_s, frozen.begin_s, frozen.end_s, !!shownReplay).then((series) => {
        if (!gone) draw(found(series), frozen.begin_s, frozen.end_s);
      }, (error: Error) => tell(error.message));
    } else if (shownReplay) {
      const redraw = once(() => {
        const end_s = position_s.peek();
        const series = ahead.at(end_s - window_s, end_s);
        if (series) draw(found(series), end_s - window_s, end_s);
      });
      const ahead = new Ahead(numbers, step_s, redraw.soon);
      ends.push(redraw.end, effect(() => {
        void position_s.value;
        redraw.soon();
      }));
    } else {
      const followed = shown.map((item) => ({ item, ...follow(item.number, step_s, now_s() - window_s - step_s) }));
      let seen = true; // on the screen, and not scrolled away
      const redraw = once(() => {
        const end_s = now_s() - SLACK_S;
        for (const { series } of followed) series.trim(end_s - window_s - 2 * step_s);
        if (seen) draw(followed, end_s - window_s, end_s);
      });
      const watch = new IntersectionObserver((changes) => {
        seen = changes[changes.length - 1]?.isIntersecting ?? true;
      });
      watch.observe(place.current);
      drawn.add(redraw.soon);
      ends.push(redraw.end, () => watch.disconnect(), () => drawn.delete(redraw.soon));
      ends.push(...followed.map(({ leave }) => leave));
    }
    return () => ends.reverse().forEach((end) => end());
  }, [key, window_s, width, frozen?.begin_s, frozen?.end_s, scheme, replayed]);

  const view = (): Range => {
    if (frozen) return frozen;
    const end_s = shownReplay ? position_s.peek() : now_s() - SLACK_S;
    return { begin_s: end_s - window_s, end_s };
  };
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
  const save = (format: "csv" | "mcap") => {
    const { begin_s, end_s } = view();
    const wanted = shown.map((item) => `item=${encodeURIComponent(item.facts.path)}`).join("&");
    location.assign(`${format}?${wanted}&begin_s=${begin_s}&end_s=${end_s}`);
  };
  const title = shown.length ? shown.map((item) => item.facts.path).join(", ") : "an empty chart";
  return (
    <section class={`chart card ${active.value === id ? "active" : ""}`} aria-label={`chart of ${title}`}
      onFocusIn={() => (active.value = id)} onPointerDown={() => (active.value = id)}
      onDragOver={(event) => event.preventDefault()} onDrop={drop}>
      <ul class="legend">
        {shownReplay && <li class="replayed">REPLAY</li>}
        {shown.map((item, index) => (
          <Key key={item.number} item={item} index={index} latest={latest}
            onRemove={() => toggle(item.facts.path, id)} />
        ))}
        {!shown.length && <li class="quiet">choose values with the button of a row, or drag their names here</li>}
      </ul>
      <div ref={place} class="plot" tabIndex={0} role="img" onKeyDown={press}
        aria-label={`${title}: arrows move, plus and minus zoom, space freezes; the table has the numbers`} />
      <div class="tools">
        <button type="button" aria-pressed={!!frozen} onClick={() => setFrozen(frozen ? null : view())}>
          {!frozen ? "freeze" : shownReplay ? "go on" : "live"}
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
        {(["csv", "mcap"] as const).map((format) => (
          <button key={format} type="button" onClick={() => save(format)} disabled={!shown.length || !!shownReplay}
            title={shownReplay ? "save the recording itself, in the list of recordings" : "save what the chart shows"}>
            {format.toUpperCase()}
          </button>
        ))}
        <button type="button" aria-pressed={table} onClick={() => setTable(!table)}>table</button>
        <button type="button" aria-label={`remove the chart of ${title}`} onClick={() => removeChart(id)}>×</button>
      </div>
      {table && <Numbers shown={shown} latest={latest} />}
    </section>
  );
}

/** Lets a drawing happen once before the next frame, however often it is asked for. */
function once(draw: () => void): { soon: () => void; end: () => void } {
  let due = 0;
  const soon = () => {
    if (due) return;
    due = requestAnimationFrame(() => {
      due = 0;
      draw();
    });
  };
  return { soon, end: () => cancelAnimationFrame(due) };
}
