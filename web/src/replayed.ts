// SPDX-License-Identifier: BSD-3-Clause
// The replay of a recording: where it is, how fast it goes, and its samples around that place.
import { effect, signal } from "@preact/signals";
import { range, replay } from "./connection";
import { tell } from "./messages";
import type { Series } from "./series";

export const SPEEDS = [0.1, 0.5, 1, 2, 5, 20];
export const position_s = signal(0);
export const playing = signal(false);
export const speed = signal(1);

let name = "";
effect(() => {
  const now = replay.value;
  if (now && now.name !== name) position_s.value = 0;
  playing.value = !!now && now.name !== name;
  name = now?.name ?? "";
});

/** Go to a time of the recording. */
export function seek(to_s: number): void {
  position_s.value = Math.min(Math.max(0, to_s), replay.value?.duration_s ?? 0);
}

export function play(on: boolean): void {
  if (on && position_s.value >= (replay.value?.duration_s ?? 0)) seek(0);
  playing.value = on;
}

let last_ms = 0;
function step(at_ms: number): void {
  if (!playing.value) return;
  const passed_s = Math.min(0.25, (at_ms - last_ms) / 1000);
  last_ms = at_ms;
  seek(position_s.value + passed_s * speed.value);
  if (position_s.value >= (replay.value?.duration_s ?? 0)) playing.value = false;
  else requestAnimationFrame(step);
}
effect(() => {
  if (!playing.value) return;
  last_ms = performance.now();
  requestAnimationFrame(step);
});

/** Series of items around a moving place. They are fetched ahead, a few windows at a time. */
export class Ahead {
  private found: Map<number, Series> | null = null;
  private begin_s = 0;
  private end_s = 0;
  private asking = false;

  constructor(
    private which: number[],
    private step_s: number,
    private come: () => void, // called when they have come
  ) {}

  /** The series that cover a range of the recording, or those that are there while better ones are fetched. */
  at(begin_s: number, end_s: number): Map<number, Series> | null {
    const whole = end_s - begin_s;
    const length_s = replay.value?.duration_s ?? 0;
    const missing = begin_s < this.begin_s && this.begin_s > 0;
    if ((!this.found || missing || end_s > this.end_s) && !this.asking) {
      this.asking = true;
      const from_s = Math.max(0, begin_s - whole);
      const to_s = Math.min(length_s + this.step_s, end_s + 3 * whole);
      range(this.which, this.step_s, from_s, to_s, true).then((found) => {
        this.found = found;
        this.begin_s = from_s;
        this.end_s = to_s >= length_s ? Infinity : to_s;
        this.asking = false;
        this.come();
      }, (error: Error) => tell(error.message));
    }
    return this.found;
  }
}
