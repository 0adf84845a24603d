// SPDX-License-Identifier: BSD-3-Clause
// What happened: to the link, by people, and what the library has logged.
import { useState } from "preact/hooks";
import { events } from "./connection";

export function Log() {
  const [kind, setKind] = useState("");
  const [wanted, setWanted] = useState("");
  const kinds = [...new Set(events.value.map((one) => one.kind))].sort();
  const found = wanted.toLowerCase();
  const shown = events.value
    .filter((one) => (!kind || one.kind === kind) && one.text.toLowerCase().includes(found)).reverse();
  return (
    <details class="card" open={events.value.length > 0}>
      <summary>events ({events.value.length})</summary>
      <div class="tools">
        <select aria-label="kind of events" value={kind} onChange={(event) => setKind(event.currentTarget.value)}>
          <option value="">all kinds</option>
          {kinds.map((one) => <option key={one} value={one}>{one}</option>)}
        </select>
        <input type="search" aria-label="search the events" placeholder="search" value={wanted}
          onInput={(event) => setWanted(event.currentTarget.value)} />
        {shown.length < events.value.length && <span class="quiet">{shown.length} of them</span>}
      </div>
      <ol class="log" tabIndex={0} aria-label="events, the newest first">
        {shown.map((one, number) => (
          <li key={shown.length - number}>
            <time>{new Date(one.wall_s * 1000).toLocaleTimeString()}</time> <b>{one.kind}</b> {one.text}
          </li>
        ))}
      </ol>
    </details>
  );
}
