// SPDX-License-Identifier: BSD-3-Clause
// The parts of the robot with their values, as the spec has them.
import { useMemo } from "preact/hooks";
import { hello, items } from "./connection";
import { active, charts, fold, folded, toggle } from "./layout";
import type { Item, Part } from "./model";
import { Setter } from "./setter";

export function Tree() {
  const told = hello.value;
  const seen = useMemo(() => new Set(told?.sees ?? []), [told]);
  return told ? <PartView part={told.tree} seen={seen} top /> : null;
}

function PartView({ part, seen, top = false }: { part: Part; seen: Set<number>; top?: boolean }) {
  const rows = part.items.filter((number) => seen.has(number)).map((number) => items[number]).filter((one) => !!one);
  const inside = (
    <>
      {part.note && <p class="note">{part.note.replaceAll("`", "")}</p>}
      {rows.length > 0 && (
        <table class="values">
          <caption class="unseen">{top ? "values of the robot" : `values of ${part.path}`}</caption>
          <thead class="unseen">
            <tr>
              <th scope="col">name</th>
              <th scope="col">value</th>
              <th scope="col">state</th>
              <th scope="col">actions</th>
            </tr>
          </thead>
          <tbody>
            {rows.map((item) => <Row key={item.facts.path} item={item} />)}
          </tbody>
        </table>
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

function Row({ item }: { item: Item }) {
  const { path, name, unit, note, kind, read, verb } = item.facts;
  const drawn = charts.value.some((one) => one.id === active.value && one.paths.includes(path));
  const drag = (event: DragEvent) => event.dataTransfer?.setData("text/plain", path);
  return (
    <>
      <tr class={item.age.value ? "stale" : ""}>
        <th scope="row" title={note || path} draggable={kind !== "bits"} onDragStart={drag}>{name}</th>
        <td class="value">{item.shown} <span class="unit">{unit}</span></td>
        <td class="about">
          {item.age.value && <span class="old">{item.age}</span>}
          {item.alarm.value && <span class="alarm">⚠ {item.alarm}</span>}
          {item.facts.on_event && !item.age.value && <span class="quiet">on event</span>}
        </td>
        <td class="act">
          {(read || verb === "write") && kind !== "bits" && (
            <button class="plot" type="button" aria-pressed={drawn} aria-label={`plot ${path}`}
              title={drawn ? "take out of the chart" : "draw in the chart"} onClick={() => toggle(path)}>
              <svg viewBox="0 0 16 16" aria-hidden="true"><path d="M1 12l4-6 4 4 6-8" /></svg>
            </button>
          )}
        </td>
      </tr>
      {verb && <tr class="set"><td colSpan={4}><Setter item={item} verb={verb} /></td></tr>}
    </>
  );
}
