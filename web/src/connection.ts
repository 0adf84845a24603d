// SPDX-License-Identifier: BSD-3-Clause
// The socket to the server: values come as rows of 64-bit floats (frames.py), all else as JSON.
import { computed, signal } from "@preact/signals";
import { type Hello, Item, type LinkEvent, type Replay, type State, contains } from "./model";
import { Series } from "./series";

const BEAT_MS = 100; // between two changes of the texts
const ALIVE_MS = 500;
const VALUES = 1;
const EVENTS = 1000; // that the page keeps

export const phase = signal<"login" | "connecting" | "on" | "lost">("connecting");
export const reason = signal(""); // why there is no connection
export const hello = signal<Hello | null>(null);
export const state = signal<State | null>(null);
export const events = signal<LinkEvent[]>([]);
export const replay = signal<Replay | null>(null); // the recording that the charts show, instead of what is live
export const beat = signal(0); // rises with each change of the texts
export const items: Item[] = [];
export const drawn = new Set<() => void>(); // called after each frame of values

/** Parts of the robot that this page may write now. */
export const held = computed(() =>
  (state.value?.leases ?? []).filter((one) => one.client === hello.value?.client && !one.ending).map((one) => one.part),
);
export const mine = (path: string): boolean => held.value.some((part) => contains(part, path));

let socket: WebSocket | null = null;
let next = 1;
let serverNow_s = 0;
let arrived_ms = 0;
let retry_ms = 250;
const answers = new Map<number, (error: string) => void>();
const ranges = new Map<number, (found: Map<number, Series>) => void>();
const live = new Map<string, { series: Series; users: number }>();

/** The time of the robot's link now, in s. It goes on if nothing comes any more. */
export function now_s(): number {
  return serverNow_s + (arrived_ms ? (performance.now() - arrived_ms) / 1000 : 0);
}

/** Seconds since 1970 of a time of the link. */
export function wall_s(time_s: number): number {
  return hello.value ? time_s - hello.value.now_s + hello.value.wall_s : time_s;
}

export async function logIn(token: string): Promise<void> {
  const answer = await fetch("login", {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify({ token }),
  });
  if (!answer.ok) throw new Error(await answer.text());
  connect();
}

export async function logOut(): Promise<void> {
  await fetch("logout", { method: "POST" });
}

export function connect(): void {
  phase.value = hello.value ? "lost" : "connecting";
  const opened = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`);
  opened.binaryType = "arraybuffer";
  socket = opened;
  let bye = "";
  opened.onmessage = ({ data }) => {
    if (typeof data === "string") bye = takeText(JSON.parse(data)) || bye;
    else takeFloats(new Float64Array(data));
  };
  opened.onclose = ({ code }) => {
    for (const answer of [...answers.values()]) answer("the connection to the server was lost");
    answers.clear();
    ranges.clear();
    state.value = state.value && { ...state.value, leases: [] };
    replay.value = null; // the server has forgotten it
    reason.value = bye || "the server does not answer";
    if (code === 1008 || bye === "you have logged out") {
      phase.value = "login";
      return;
    }
    phase.value = hello.value ? "lost" : "connecting";
    setTimeout(connect, retry_ms);
    retry_ms = Math.min(4000, retry_ms * 2);
  };
}

function takeText(message: Record<string, unknown>): string {
  if (message.hello) {
    const told = message.hello as Hello;
    if (hello.value && told.now_s < serverNow_s) location.reload(); // another board, whose time began anew
    serverNow_s = told.now_s;
    arrived_ms = performance.now();
    const old = items.splice(0);
    told.items.forEach((facts, number) => {
      const same = old[number]?.facts.path === facts.path ? old[number] : undefined;
      const item = new Item(number, facts, told.rates[number] ?? 0);
      item.value = same?.value ?? null;
      item.time_s = same?.time_s ?? 0;
      items.push(item);
    });
    takeTexts(told.texts);
    hello.value = told;
    events.value = told.events;
    phase.value = "on";
    retry_ms = 250;
    sendView();
  }
  if (message.state) state.value = message.state as State;
  if (message.texts) takeTexts(message.texts as Record<string, string>);
  if (message.replay) replay.value = message.replay as Replay;
  if (message.event) events.value = [...events.value.slice(1 - EVENTS), message.event as LinkEvent];
  if (message.answer) {
    answers.get(message.answer as number)?.((message.error as string) ?? "");
    answers.delete(message.answer as number);
  }
  return typeof message.bye === "string" ? message.bye : "";
}

function takeTexts(texts: Record<string, string>): void {
  for (const [number, text] of Object.entries(texts)) {
    const item = items[Number(number)];
    if (item) item.text = text;
  }
}

function takeFloats(row: Float64Array): void {
  let at = 0;
  const take = (): number => row[at++] ?? 0;
  if (take() === VALUES) {
    serverNow_s = take();
    arrived_ms = performance.now();
    for (let left = take(); left > 0; left--) {
      const item = items[take()];
      const time_s = take();
      const value = take();
      if (item) Object.assign(item, { time_s, value });
    }
    for (let left = take(); left > 0; left--) {
      const item = take();
      const step_s = take();
      const found = live.get(`${item} ${step_s}`)?.series ?? new Series(step_s);
      at = found.take(row, at);
    }
    for (const draw of drawn) draw();
  } else {
    const number = take();
    const found = new Map<number, Series>();
    for (let left = take(); left > 0; left--) {
      const item = take();
      const series = new Series(take());
      at = series.take(row, at);
      found.set(item, series);
    }
    ranges.get(number)?.(found);
    ranges.delete(number);
  }
}

/** Ask for something. The promise is rejected with the server's reason if it refuses. */
export function ask(what: string, facts: Record<string, unknown> = {}): Promise<void> {
  return new Promise((done, failed) => {
    if (socket?.readyState !== WebSocket.OPEN) return failed(new Error("there is no connection to the server"));
    const id = next++;
    answers.set(id, (error) => (error ? failed(new Error(error)) : done()));
    socket.send(JSON.stringify({ do: what, id, ...facts }));
  });
}

/** Fetch series of items between two times, once: live ones, or those of the replay. */
export function range(
  which: number[], step_s: number, begin_s: number, end_s: number, replayed = false,
): Promise<Map<number, Series>> {
  return new Promise((done, failed) => {
    const id = next;
    ranges.set(id, done);
    ask("range", { series: which.map((item) => [item, step_s, begin_s]), end_s, replay: replayed }).catch((error) => {
      ranges.delete(id);
      failed(error);
    });
  });
}

/** Get a series that goes on, at least from `begin_s`. The answer gives it back. */
export function follow(item: number, step_s: number, begin_s: number): { series: Series; leave: () => void } {
  const key = `${item} ${step_s}`;
  let one = live.get(key);
  if (!one) live.set(key, (one = { series: new Series(step_s), users: 0 }));
  const kept = one;
  kept.users++;
  kept.series.begin_s = Math.min(kept.series.begin_s, begin_s);
  if (kept.series.numbers.length && kept.series.begin_s < (kept.series.numbers[0] ?? 0) * step_s) kept.series.clear();
  sendView();
  return {
    series: kept.series,
    leave: () => {
      if (--kept.users === 0) live.delete(key);
      sendView();
    },
  };
}

let viewing = false;
function sendView(): void {
  if (viewing) return;
  viewing = true; // several charts may change at once
  queueMicrotask(() => {
    viewing = false;
    if (socket?.readyState !== WebSocket.OPEN) return;
    const series = [...live].map(([key, { series }]) => [Number(key.split(" ")[0]), series.step_s, series.next_s()]);
    ask("view", { series }).catch(() => undefined);
  });
}

setInterval(() => {
  if (!hello.value) return;
  const time_s = now_s();
  for (const item of items) item.refresh(time_s);
  beat.value++;
}, BEAT_MS);
setInterval(() => {
  if (held.value.length && socket?.readyState === WebSocket.OPEN) socket.send('{"do":"alive"}');
}, ALIVE_MS);
