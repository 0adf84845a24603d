// SPDX-License-Identifier: BSD-3-Clause
// How the link does: losses, round trip, and the publishes as they are asked for and as they come.
import { useRef } from "preact/hooks";
import { beat, hello, items, state } from "./connection";
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

const HEADS: [string, string][] = [
  ["publish", "values that are sampled together"],
  ["asked", "the rate that was asked for"],
  ["comes", "the rate that comes"],
  ["lost", "publishes that did not come, or came too fast to be taken"],
  ["promised within", "the budget: the sample is taken so long after its tick at most"],
  ["came within", "how far two samples were from their distance, the worst of the last 10 to 20 s"],
  ["sent within", "the budget: the last byte has left the board so long after the tick"],
];
const micro = (time_s: number | null): string =>
  (time_s === null ? "–" : `${(time_s * 1e6).toFixed(time_s < 1e-5 ? 1 : 0)} µs`);

/** What the budget says of the line, and what comes. */
function Line({ line, comes }: { line: NonNullable<State["line"]>; comes: number | null }) {
  const load = line.baud_hz && comes !== null ? ` ${((comes * 1000) / line.baud_hz).toFixed(1)} %` : "";
  return (
    <p>
      Budget of the line: publishes take {line.bytes_per_s.toFixed(0)} B/s
      {line.load !== null && line.baud_hz !== null
        ? `, which is ${(line.load * 100).toFixed(1)} % of ${line.baud_hz} baud. All that comes takes${load || " –"}.`
        : ". This link has no baud rate, so no times are promised."}
    </p>
  );
}

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
      {now.line && <Line line={now.line} comes={bytes("bytes_received")} />}
      <div class="wide" tabIndex={0} role="region" aria-label="publishes">
        <table>
          <thead>
            <tr>{HEADS.map(([name, title]) => <th key={name} scope="col" title={title}>{name}</th>)}</tr>
          </thead>
          <tbody>
            {now.publishes.map((one, number) => {
              const comes = rate((each) => each.publishes[number]?.received);
              const slow = comes !== null && span_s > 3 && one.rate_hz > 0 && comes < 0.95 * one.rate_hz;
              const late = one.off_s !== null && one.sampled_s !== null && one.off_s > one.sampled_s;
              return (
                <tr key={one.paths[0]}>
                  <th scope="row" title={one.paths.join(", ")}>
                    {one.paths[0]}{one.paths.length > 1 && ` and ${one.paths.length - 1} more`}
                    {!one.hardware && <span class="quiet"> read by the PC</span>}
                  </th>
                  <td>{one.rate_hz ? `${one.rate_hz.toFixed(0)} Hz` : "on event"}</td>
                  <td class={slow ? "alarm" : ""}>{slow && "⚠ "}{text(comes, 1)} Hz</td>
                  <td>{one.lost}</td>
                  <td>{micro(one.sampled_s)}</td>
                  <td class={late ? "alarm" : ""}>{late && "⚠ "}{micro(one.off_s)}</td>
                  <td>{micro(one.sent_s)}</td>
                </tr>
              );
            })}
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
