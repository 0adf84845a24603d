// SPDX-License-Identifier: BSD-3-Clause
// The groups of the spec: their set-points side by side, written at once.
import { hello, items, mine } from "./connection";
import { tell } from "./messages";
import type { Item } from "./model";
import { drafts, parsed, setDraft, write } from "./setter";

export function Groups() {
  const told = hello.value;
  const groups = (told?.groups ?? []).map(({ path, items: numbers }) => ({
    path,
    written: numbers.map((number) => items[number]).filter((one): one is Item => one?.facts.verb === "write"),
  }));
  const shown = groups.filter((one) => one.written.length > 1 && one.written.some((item) => mayWrite(item)));
  return <>{shown.map(({ path, written }) => <Group key={path} path={path} written={written} />)}</>;
}

const mayWrite = (item: Item): boolean => (hello.value?.sees ?? []).includes(item.number);

function Group({ path, written }: { path: string; written: Item[] }) {
  const typed = written.filter((item) => drafts.value.has(item.facts.path));
  const may = written.every((item) => mine(item.facts.path));
  const fill = () => {
    for (const item of written) if (item.value !== null) setDraft(item.facts.path, item.shown.value);
  };
  const send = (event: Event) => {
    event.preventDefault();
    try {
      write(typed.map((item): [Item, unknown] => [item, parsed(item, drafts.value.get(item.facts.path) ?? "")]));
    } catch (error) {
      tell((error as Error).message);
    }
  };
  return (
    <details class="card group" open>
      <summary>{path} <span class="quiet">written at once</span></summary>
      <form onSubmit={send}>
        {written.map((item) => (
          <label key={item.number}>
            <span>{item.facts.path}</span>
            <GroupBox item={item} may={may} />
            <span class="unit">{item.facts.unit}</span>
          </label>
        ))}
        <div class="tools">
          <button type="submit" disabled={!may || !typed.length}>write {path}</button>
          <button type="button" disabled={!may} onClick={fill}>fill in what is there</button>
        </div>
      </form>
    </details>
  );
}

function GroupBox({ item, may }: { item: Item; may: boolean }) {
  const { path, kind, members } = item.facts;
  const draft = drafts.value.get(path);
  const take = (text: string) => setDraft(path, text || null);
  const words = kind === "bool" ? ["false", "true"] : kind === "enum" ? members?.map(([, name]) => name) : null;
  const label = `${path} in the group`;
  return words ? (
    <select aria-label={label} disabled={!may} value={draft ?? ""}
      onChange={(event) => take(event.currentTarget.value)}>
      <option value="">{item.shown.value}</option>
      {words.map((one) => <option key={one} value={one}>{one}</option>)}
    </select>
  ) : (
    <input aria-label={label} inputMode="decimal" autocomplete="off" disabled={!may} value={draft ?? ""}
      placeholder={item.shown.value} class={draft !== undefined ? "draft" : ""}
      onInput={(event) => take(event.currentTarget.value)} />
  );
}
