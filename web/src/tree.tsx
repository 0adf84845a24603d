// SPDX-License-Identifier: BSD-3-Clause
// The parts of the robot with their values, as the spec has them.
import { useMemo } from "preact/hooks";
import { hello, items } from "./connection";
import { active, charts, favour, favourites, fold, folded, toggle } from "./layout";
import type { Item, Part } from "./model";
import { Setter } from "./setter";

export function Tree() {
  const told = hello.value;
  const seen = useMemo(() => new Set(told?.sees ?? []), [told]);
  return told ? <PartView part={told.tree} seen={seen} top /> : null;
}

/** The values that somebody wants to see first. */
export function Favourites() {
  const seen = useMemo(() => new Set(hello.value?.sees ?? []), [hello.value]);
  const shown = items.filter((item) => favourites.value.has(item.facts.path) && seen.has(item.number));
  if (!shown.length) return null;
  return (
    <section class="card favourites" aria-label="favourites">
      <Rows caption="favourite values" rows={shown} whole />
    </section>
  );
}

function Rows({ caption, rows, whole = false }: { caption: string; rows: Item[]; whole?: boolean }) {
  return (
    <table class="values">
      <caption class="unseen">{caption}</caption>
      <thead class="unseen">
        <tr>
          <th scope="col">name</th>
          <th scope="col">value</th>
          <th scope="col">state</th>
          <th scope="col">actions</th>
        </tr>
      </thead>
      <tbody>
        {rows.map((item) => <Row key={item.facts.path} item={item} whole={whole} />)}
      </tbody>
    </table>
  );
}

function PartView({ part, seen, top = false }: { part: Part; seen: Set<number>; top?: boolean }) {
  const rows = part.items.filter((number) => seen.has(number)).map((number) => items[number]).filter((one) => !!one);
  const inside = (
    <>
      {part.note && <p class="note">{part.note.replaceAll("`", "")}</p>}
      {rows.length > 0 && (
        <Rows caption={top ? "values of the robot" : `values of ${part.path}`} rows={rows} />
      )}
      {part.parts.map((below) => <PartView key={below.path} part={below} seen={seen} />)}
    </>
  );
  if (top) return <div class="tree">{inside}</div>;
  return (
    <details open={!folded.value.has(part.path)} onToggle={(event) => fold(part.path, !event.currentTarget.open)}>
      <summary>
        {part.name} {part.display !== part.path && part.display !== part.name && (
          <span class="quiet">{part.display}</span>
        )}
      </summary>
      {inside}
    </details>
  );
}

/** `whole`: it has the whole path of the item, and no box to write it. */
function Row({ item, whole }: { item: Item; whole: boolean }) {
  const { path, name, unit, note, kind, read, verb } = item.facts;
  const drawn = charts.value.some((one) => one.id === active.value && one.paths.includes(path));
  const drag = (event: DragEvent) => event.dataTransfer?.setData("text/plain", path);
  return (
    <>
      <tr class={item.age.value ? "stale" : ""}>
        <th scope="row" title={note || path} draggable={kind !== "bits"} onDragStart={drag}>{whole ? path : name}</th>
        <td class="value">{item.shown} <span class="unit">{unit}</span></td>
        <td class="about">
          {item.age.value && <span class="old">{item.age}</span>}
          {item.alarm.value && <span class="alarm">⚠ {item.alarm}</span>}
          {item.facts.on_event && !item.age.value && <span class="quiet">on event</span>}
        </td>
        <td class="act">
          <button class="plot star" type="button" aria-pressed={favourites.value.has(path)}
            aria-label={`favourite ${path}`} title="show it at the top" onClick={() => favour(path)}>
            <svg viewBox="0 0 16 16" aria-hidden="true">
              <path d="M8 2l1.8 4 4.2.4-3.2 2.9 1 4.2L8 11.2l-3.8 2.3 1-4.2L2 6.4 6.200 6z" />
            </svg>
          </button>
          {(read || verb === "write") && kind !== "bits" && (
            <button class="plot" type="button" aria-pressed={drawn} aria-label={`plot ${path}`}
              title={drawn ? "take out of the chart" : "draw in the chart"} onClick={() => toggle(path)}>
              <svg viewBox="0 0 16 16" aria-hidden="true"><path d="M1 12l4-6 4 4 6-8" /></svg>
            </button>
          )}
        </td>
      </tr>
      {verb && !whole && <tr class="set"><td colSpan={4}><Setter item={item} verb={verb} /></td></tr>}
    </>
  );
}
