// SPDX-License-Identifier: BSD-3-Clause
/** The least and the greatest value of one item in each bucket of time, as history.py has them. */
export class Series {
  numbers: number[] = [];
  least: number[] = [];
  greatest: number[] = [];
  begin_s = Infinity; // older buckets are not wanted

  constructor(readonly step_s: number) {}

  /** Take the rows of a frame from `at` on, and return where they end. The newest bucket may come again. */
  take(row: Float64Array, at: number): number {
    const count = row[at++] ?? 0;
    for (let left = count; left > 0; left--, at += 3) {
      const number = row[at] ?? 0;
      while (this.numbers.length && (this.numbers[this.numbers.length - 1] ?? 0) >= number) this.pop();
      this.numbers.push(number);
      this.least.push(row[at + 1] ?? NaN);
      this.greatest.push(row[at + 2] ?? NaN);
    }
    return at;
  }

  private pop(): void {
    this.numbers.pop();
    this.least.pop();
    this.greatest.pop();
  }

  clear(): void {
    this.numbers = [];
    this.least = [];
    this.greatest = [];
  }

  /** The time from which the next buckets are wanted. The newest one is not complete yet. */
  next_s(): number {
    return this.numbers.length ? (this.numbers[this.numbers.length - 1] ?? 0) * this.step_s + this.step_s / 2
      : this.begin_s;
  }

  /** Forget what is before a time. */
  trim(time_s: number): void {
    const first = this.from(time_s);
    if (first < 1000) return; // cutting is dear, so it is done seldom
    this.numbers.splice(0, first);
    this.least.splice(0, first);
    this.greatest.splice(0, first);
  }

  /** The greatest value of the last bucket that begins at a time or before, if there is one. */
  before(time_s: number): number | undefined {
    const at = this.from(time_s + this.step_s) - 1;
    return this.greatest[at];
  }

  /** The index of the first bucket that is not before a time. */
  from(time_s: number): number {
    const number = Math.floor(time_s / this.step_s);
    let low = 0;
    let high = this.numbers.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((this.numbers[middle] ?? 0) < number) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}
