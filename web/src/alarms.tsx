// SPDX-License-Identifier: BSD-3-Clause
// Values that are or were beyond their limits, until somebody has seen it.
import { ask, hello, items, state } from "./connection";
import { tell } from "./messages";
import type { Alarm } from "./model";

const clock = (seconds: number): string => new Date(seconds * 1000).toLocaleTimeString();

export function Alarms() {
  const alarms = state.value?.alarms ?? [];
  if (!alarms.length) return null;
  const open = [...new Set(alarms.filter((one) => !one.seen_by).map((one) => items[one.item]?.facts.path ?? ""))];
  const see = (paths: string[]) =>
    paths.forEach((path) => ask("acknowledge", { path }).catch((error: Error) => tell(error.message)));
  const may = (hello.value?.writes.length ?? 0) > 0;
  return (
    <section class="card alarms" aria-label="alarms">
      <h2>
        ⚠ alarms ({alarms.length})
        {may && open.length > 1 && <button type="button" onClick={() => see(open)}>acknowledge all</button>}
      </h2>
      <ul>{alarms.map((one) => <One key={`${one.item} ${one.above}`} alarm={one} may={may} see={see} />)}</ul>
    </section>
  );
}

function One({ alarm, may, see }: { alarm: Alarm; may: boolean; see: (paths: string[]) => void }) {
  const item = items[alarm.item];
  if (!item) return null;
  const { path, unit } = item.facts;
  const worst = alarm.worst === null ? "" : `, up to ${item.format(alarm.worst)} ${unit}`;
  const side = alarm.above ? "above" : "below";
  const times = alarm.count > 1 ? `, ${alarm.count} times` : "";
  return (
    <li class={alarm.ended_s === null ? "lasts" : ""}>
      <span>
        <b>{path}</b> {alarm.ended_s === null ? "is" : "was"} {side} {item.format(alarm.limit)} {unit}
        {worst.replace("up to", alarm.above ? "up to" : "down to")}, since {clock(alarm.begun_s)}
        {alarm.ended_s !== null && ` until ${clock(alarm.ended_s)}`}{times}
        {alarm.seen_by && <span class="quiet"> seen by {alarm.seen_by}</span>}
      </span>
      {may && !alarm.seen_by && (
        <button type="button" aria-label={`acknowledge the alarm of ${path}`} onClick={() => see([path])}>
          acknowledge
        </button>
      )}
    </li>
  );
}

/** What a screen reader says when an alarm begins. */
export function AlarmCount() {
  const open = (state.value?.alarms ?? []).filter((one) => !one.seen_by);
  const paths = [...new Set(open.map((one) => items[one.item]?.facts.path ?? ""))];
  const many = paths.length === 1 ? "alarm" : `${paths.length} alarms`;
  const text = paths.length ? `⚠ ${many}: ${paths.join(", ")}` : "";
  return <span role="alert" class="alarmed">{text}</span>;
}
