// SPDX-License-Identifier: BSD-3-Clause
// How the link does: losses, round trip, and the publishes as they are asked for and as they come.
import { useRef } from "preact/hooks";
import { beat, events, hello, items, state } from "./connection";
import type { State } from "./model";

const COUNTERS: [string, string][] = [
  ["requests", "requests"],
  ["retries", "sent again"],
  ["timeouts", "timeouts"],
  ["checksum_errors", "checksum errors"],
  ["missing_publishes", "publishes lost on the way"],
  ["overruns", "overruns"],
  ["restarts", "restarts of the device"],
  ["reconnections", "reconnections"],
];

export function Health() {
  const now = state.value;
  const told = hello.value;
  const before = useRef<{ state: State; at_ms: number }[]>([]);
  if (!now || !told) return null;
  const past = before.current;
  if (past[past.length - 1]?.state !== now) past.push({ state: now, at_ms: performance.now() });
  while (past.length > 12) past.shift();
  const first = past[0];
  const last = past[past.length - 1];
  const span_s = first && last && last !== first ? (last.at_ms - first.at_ms) / 1000 : 0;
  const rate = (pick: (one: State) => number | undefined) =>
    first && last && span_s > 0 ? ((pick(last.state) ?? 0) - (pick(first.state) ?? 0)) / span_s : null;
  const bytes = (name: string) => rate((one) => one.statistics[name]);
  const text = (value: number | null, digits: number) => (value === null ? "–" : value.toFixed(digits));
  return (
    <details class="card" open>
      <summary>link</summary>
      <p>
        {told.link}, {told.protocol}, {now.up ? "up" : `down: ${now.trouble}`}. Round trip{" "}
        <b>{now.round_trip_s === null ? "–" : `${(now.round_trip_s * 1000).toFixed(2)} ms`}</b>, in{" "}
        {text(bytes("bytes_received"), 0)} B/s, out {text(bytes("bytes_sent"), 0)} B/s.
      </p>
      <div class="wide" tabIndex={0} role="region" aria-label="publishes">
        <table>
          <thead>
            <tr>{["publish", "asked", "comes", "lost"].map((one) => <th key={one} scope="col">{one}</th>)}</tr>
          </thead>
          <tbody>
            {now.publishes.map((one, number) => (
              <tr key={one.paths[0]}>
                <th scope="row" title={one.paths.join(", ")}>
                  {one.paths[0]}{one.paths.length > 1 && ` and ${one.paths.length - 1} more`}
                  {!one.hardware && <span class="quiet"> read by the PC</span>}
                </th>
                <td>{one.rate_hz ? `${one.rate_hz.toFixed(0)} Hz` : "on event"}</td>
                <td>{text(rate((each) => each.publishes[number]?.received), 1)} Hz</td>
                <td>{one.lost}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <dl>
        {COUNTERS.map(([name, words]) => (
          <div key={name}><dt>{words}</dt><dd>{now.statistics[name] ?? 0}</dd></div>
        ))}
      </dl>
      <p class="quiet">{now.viewers} {now.viewers === 1 ? "page is" : "pages are"} open: {now.users.join(", ")}</p>
    </details>
  );
}

/** One line for the head of the page, which a screen reader may ask for. */
export function Pulse() {
  void beat.value;
  const late = items.filter((item) => item.age.value).length;
  const up = state.value?.up;
  return (
    <span class={`pulse ${up && !late ? "good" : "poor"}`}>
      {up === false ? "⚠ link down" : late ? `⚠ ${late} values are old` : "● live"}
    </span>
  );
}

export function Log() {
  const shown = [...events.value].reverse();
  return (
    <details class="card" open={shown.length > 0}>
      <summary>events ({shown.length})</summary>
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
