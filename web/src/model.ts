// SPDX-License-Identifier: BSD-3-Clause
// What the server tells of the robot. Python's description.py and station.py write it.
import { signal } from "@preact/signals";

export interface Facts {
  path: string;
  name: string;
  display: string;
  note: string;
  unit: string;
  kind: "number" | "bool" | "enum" | "bits";
  whole: boolean;
  digits: number | null; // after the point; null: as many as matter
  text: boolean; // the value comes as text, because a number of JavaScript cannot hold it
  verb: "write" | "pulse" | "clear" | null;
  read: boolean;
  confirm: string | null;
  on_event: boolean;
  members?: [number, string][];
  minimum: number | null;
  maximum: number | null;
  initial: number | null;
  safe: number | null;
  least?: number | string;
  greatest?: number | string;
}

export interface Part {
  path: string;
  name: string;
  display: string;
  note: string;
  items: number[];
  parts: Part[];
}

export interface LinkEvent {
  time_s: number;
  wall_s: number;
  kind: string;
  text: string;
}

export interface Hello {
  robot: string;
  items: Facts[];
  tree: Part;
  groups: { path: string; items: number[] }[];
  can_stop: boolean;
  link: string;
  protocol: string;
  user: string;
  client: number;
  writes: string[];
  may_arm: boolean;
  may_break: boolean;
  may_see_recordings: boolean;
  has_status: boolean;
  has_body: boolean;
  sees: number[];
  rates: number[];
  texts: Record<string, string>;
  events: LinkEvent[];
  now_s: number;
  wall_s: number;
}

export interface Lease {
  part: string;
  holder: string;
  client: number;
  left_s: number;
  ending: string;
}

/** Somebody wants a part that another one holds. */
export interface Wish {
  part: string;
  user: string;
}

/** A publish: what was asked for and came. Times in s, null if there is no promise, or nothing to compare. */
export interface Publish {
  paths: string[];
  hardware: boolean;
  rate_hz: number;
  received: number;
  lost: number;
  sampled_s: number | null;
  sent_s: number | null;
  off_s: number | null;
}

export interface Alarm {
  item: number;
  above: boolean;
  limit: number;
  worst: number | null;
  begun_s: number;
  ended_s: number | null;
  count: number;
  seen_by: string;
}

export interface Recording {
  name: string;
  by: string;
  samples: number;
  size_bytes: number;
  lost: number;
  seconds: number;
}

/** A recording that is shown. Its times begin at 0, which is `begun_s` since 1970. */
export interface Replay {
  name: string;
  begun_s: number;
  duration_s: number;
  items: number[];
  notice: string;
}

export interface State {
  up: boolean;
  trouble: string;
  stopped_by: string;
  stops: number; // another one after each stop: who goes on says of which he knew
  leases: Lease[];
  wishes: Wish[];
  users: string[];
  viewers: number;
  round_trip_s: number | null;
  statistics: Record<string, number>;
  publishes: Publish[];
  line: { bytes_per_s: number; baud_hz: number | null; load: number | null } | null;
  recording: Recording | null;
  alarms: Alarm[];
}

/** One item with its newest value. `shown` and `age` are texts, so a row changes only if they do. */
export class Item {
  value: number | null = null;
  time_s = 0;
  text = "";
  shown = signal("");
  age = signal("");
  alarm = signal("");

  constructor(
    readonly number: number,
    readonly facts: Facts,
    readonly rate_hz: number,
  ) {}

  format(value: number): string {
    const { kind, members, whole, digits } = this.facts;
    if (kind === "bool") return value ? "true" : "false";
    if (kind === "enum") return members?.find(([number]) => number === value)?.[1] ?? String(value);
    if (whole || !Number.isFinite(value)) return String(value);
    if (digits !== null) return value.toFixed(digits);
    return value !== 0 && (Math.abs(value) < 1e-4 || Math.abs(value) >= 1e7) ? value.toExponential(4)
      : String(Number(value.toPrecision(6)));
  }

  /** How old the value is, if it is overdue; else "". It is then shown in grey, with its age. */
  overdue(now_s: number): string {
    const age_s = now_s - this.time_s;
    if (this.value === null || this.rate_hz <= 0 || age_s <= Math.max(1, 3 / this.rate_hz)) return "";
    return age_s < 100 ? `${age_s.toFixed(0)} s old` : `${(age_s / 60).toFixed(0)} min old`;
  }

  refresh(now_s: number): void {
    const { minimum, maximum, kind, text } = this.facts;
    const value = this.value;
    this.shown.value = value === null ? "–" : text && this.text ? this.text : this.format(value);
    this.age.value = this.overdue(now_s);
    const limited = value !== null && kind === "number";
    this.alarm.value = limited && maximum !== null && value > maximum ? `above ${maximum}`
      : limited && minimum !== null && value < minimum ? `below ${minimum}` : "";
  }
}

/** Whether the subtree `outer` has `inner` in it, or is the same. As in Python's subtree.py. */
export function contains(outer: string, inner: string): boolean {
  return outer === "" || inner === outer || (inner.startsWith(outer) && ".[".includes(inner[outer.length] ?? ""));
}
