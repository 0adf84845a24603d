// SPDX-License-Identifier: BSD-3-Clause
// A server within the page that plays an hour: it answers requests, and sends frames of which each is frame_s later.
([values, frame_s]) => {
  const item = (number) => ({
    path: `v${number}`, name: `v${number}`, display: "", note: "", unit: "mm", kind: "number", whole: false, digits: 2,
    text: false, verb: null, read: true, confirm: null, on_event: false, minimum: null, maximum: null, initial: null,
    safe: null,
  });
  const numbers = [...Array(values).keys()];
  const hello = { robot: "arm", items: numbers.map(item), groups: [], can_stop: true, link: "sim", protocol: "framed",
    tree: { path: "", name: "arm", display: "", note: "", items: numbers, parts: [] }, user: "ana", client: 1,
    writes: [], may_arm: false, may_break: false, may_see_recordings: false, has_body: false, sees: numbers,
    rates: numbers.map(() => 1000), texts: {}, events: [], now_s: 0, wall_s: 1e9 };
  const state = { up: true, trouble: "", stopped_by: "", stops: 0, leases: [], users: ["ana"], viewers: 1,
    round_trip_s: 1e-4, statistics: {}, publishes: [], line: null, recording: null, alarms: [] };
  let now_s = 0;
  let view = [];
  class Fake {
    static OPEN = 1;
    readyState = 1;
    constructor() {
      window.server = this;
      setTimeout(() => {
        this.onmessage({ data: JSON.stringify({ hello }) });
        this.onmessage({ data: JSON.stringify({ state }) });
      });
    }
    send(text) {
      const asked = JSON.parse(text);
      if (asked.do === "view")
        view = asked.series.map(([number, step_s, from_s]) => [number, step_s, Math.floor(from_s / step_s)]);
      if (asked.id) setTimeout(() => this.onmessage({ data: JSON.stringify({ answer: asked.id }) }));
    }
  }
  window.WebSocket = Fake;
  window.fetch = () => Promise.resolve({ ok: true, text: () => "", json: () => ({}) });
  const frame = () => {
    now_s += frame_s;
    const row = [1, now_s, values, ...numbers.flatMap((number) => [number, now_s, Math.sin(now_s + number)])];
    row.push(view.length);
    for (const one of view) {
      const last = Math.floor(now_s / one[1]);
      const found = [];
      for (let bucket = one[2]; bucket <= last; bucket++)
        found.push(bucket, Math.sin(bucket / 9), 1.1 * Math.sin(bucket / 9));
      row.push(one[0], one[1], found.length / 3, ...found);
      one[2] = last;
    }
    window.server.onmessage({ data: new Float64Array(row).buffer });
  };
  window.play = async (seconds) => {
    for (let left = Math.round(seconds / frame_s); left > 0; left--) {
      frame();
      if (left % 300 === 0) {
        const event = { time_s: now_s, wall_s: 1e9, kind: "log", text: `at ${now_s}` };
        window.server.onmessage({ data: JSON.stringify({ state, event }) });
        await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
      }
    }
    return now_s;
  };
}
