// SPDX-License-Identifier: BSD-3-Clause
// How a person writes an item: a box, a slider, a switch, a list or a button. It works with control of the part.
import { signal } from "@preact/signals";
import { useRef } from "preact/hooks";
import { ask, mine } from "./connection";
import { confirmed } from "./confirm";
import type { Item } from "./model";
import { tell } from "./messages";

/** What has been typed and not been written yet, by path. It can be written together. */
export const drafts = signal<ReadonlyMap<string, string>>(new Map());

export function setDraft(path: string, text: string | null): void {
  const now = new Map(drafts.value);
  if (text === null) now.delete(path);
  else now.set(path, text);
  drafts.value = now;
}

/** The value that a text means. A number too long for JavaScript, and a packed value, go as text. */
export function parsed(item: Item, text: string): unknown {
  const { kind, members, path, text: wide } = item.facts;
  if (kind === "enum") return members?.find(([, name]) => name === text)?.[0] ?? text;
  if (kind === "bool") return text === "true";
  if (wide) return text.trim();
  const number = Number(text.replace(",", "."));
  if (text.trim() === "" || !Number.isFinite(number)) throw new Error(`${path}: “${text}” is no number`);
  return number;
}

/** Write values together, after the questions of the spec. Return whether they were written. */
export async function write(values: [Item, unknown][]): Promise<boolean> {
  for (const [item] of values) if (!(await confirmed(item.facts.confirm))) return false;
  try {
    await ask("write", { values: Object.fromEntries(values.map(([item, value]) => [item.facts.path, value])) });
    for (const [item] of values) setDraft(item.facts.path, null);
    return true;
  } catch (error) {
    tell((error as Error).message);
    return false;
  }
}

export function Setter({ item, verb }: { item: Item; verb: "write" | "pulse" | "clear" }) {
  const { path, name, kind } = item.facts;
  const mayWrite = mine(path);
  if (verb !== "write") {
    const act = async () => {
      if (!(await confirmed(item.facts.confirm))) return;
      ask(verb, { path }).catch((error: Error) => tell(error.message));
    };
    return (
      <button type="button" disabled={!mayWrite} onClick={act}>{verb === "clear" ? `clear ${name}` : name}</button>
    );
  }
  if (kind === "bool") {
    const on = item.shown.value === "true";
    return (
      <button type="button" role="switch" class="switch" aria-checked={on} aria-label={path} disabled={!mayWrite}
        onClick={() => write([[item, !on]])}>
        <span aria-hidden="true" />{on ? "on" : "off"}
      </button>
    );
  }
  if (kind === "enum") {
    const choose = async (box: HTMLSelectElement) => {
      if (!(await write([[item, parsed(item, box.value)]]))) box.value = item.shown.value;
    };
    return (
      <select aria-label={`set ${path}`} disabled={!mayWrite} value={item.shown.value}
        onChange={(event) => choose(event.currentTarget)}>
        {item.shown.value === "–" && <option>–</option>}
        {item.facts.members?.map(([number, member]) => <option key={number}>{member}</option>)}
      </select>
    );
  }
  return <Box item={item} mayWrite={mayWrite} />;
}

function Box({ item, mayWrite }: { item: Item; mayWrite: boolean }) {
  const { path, unit, minimum, maximum, digits, whole, least, greatest, confirm } = item.facts;
  const draft = drafts.value.get(path);
  const limited = minimum !== null && maximum !== null && !confirm && !item.facts.text;
  const step = whole ? 1 : digits === null ? "any" : 10 ** -digits;
  const send = (event: Event) => {
    event.preventDefault();
    try {
      if (draft !== undefined) write([[item, parsed(item, draft)]]);
    } catch (error) {
      tell((error as Error).message);
    }
  };
  const range = least !== undefined ? `${least} to ${greatest}${unit ? ` ${unit}` : ""}` : "";
  return (
    <form class="box" onSubmit={send}>
      {limited && <Slider item={item} mayWrite={mayWrite} step={step} />}
      <input aria-label={`new value of ${path}${range ? `, ${range}` : ""}`} title={range} inputMode="decimal"
        autocomplete="off" disabled={!mayWrite} value={draft ?? ""} placeholder={item.shown.value}
        class={draft !== undefined ? "draft" : ""}
        onInput={(event) => setDraft(path, event.currentTarget.value || null)} />
      {unit && <span class="unit">{unit}</span>}
      <button type="submit" disabled={!mayWrite || draft === undefined}>set</button>
    </form>
  );
}

/** While a slider moves, its newest value goes out as soon as the last one has been written. */
function Slider({ item, mayWrite, step }: { item: Item; mayWrite: boolean; step: number | "any" }) {
  const { path, minimum, maximum, unit } = item.facts;
  const moving = useRef<{ busy: boolean; next: number | null; until_ms: number }>({
    busy: false,
    next: null,
    until_ms: 0,
  });
  const move = async (value: number) => {
    const now = moving.current;
    now.next = value;
    now.until_ms = performance.now() + 500;
    if (now.busy) return;
    now.busy = true;
    while (now.next !== null) {
      const wanted = now.next;
      now.next = null;
      await write([[item, wanted]]);
    }
    now.busy = false;
  };
  void item.shown.value; // follows the value, except while it is moved
  const props = performance.now() < moving.current.until_ms ? {} : { value: item.value ?? minimum ?? 0 };
  return (
    <input type="range" aria-label={`set ${path}`} aria-valuetext={`${item.shown.value} ${unit}`} min={minimum ?? 0}
      max={maximum ?? 0} step={step} disabled={!mayWrite} {...props}
      onInput={(event) => move(Number(event.currentTarget.value))} />
  );
}
