// SPDX-License-Identifier: BSD-3-Clause
// The stop. It is a request of its own, which works while the socket is stuck, and it is repeated until it is answered.
import { signal } from "@preact/signals";
import { ask, hello, state } from "./connection";
import { tell } from "./messages";

const ANSWER_MS = 3000;
const AGAIN_MS = 300;
const TRIES = 20;
const TWICE_MS = 600;

const outcome = signal<{ text: string; bad: boolean } | null>(null);
let stopping = false;

export async function stop(): Promise<void> {
  if (stopping) return;
  stopping = true;
  outcome.value = { text: "stopping …", bad: false };
  for (let tries = 1; tries <= TRIES; tries++) {
    try {
      const answer = await fetch("stop", { method: "POST", signal: AbortSignal.timeout(ANSWER_MS) });
      if (answer.status === 401) {
        outcome.value = { text: "NOT STOPPED: you are not logged in", bad: true };
        break;
      }
      const told = await answer.json();
      if (answer.ok) {
        const ms = (told.seconds * 1000).toFixed(0);
        outcome.value = { text: `stopped: ${told.wrote} SAFE values written in ${ms} ms`, bad: false };
        break;
      }
      outcome.value = { text: `NOT STOPPED: ${told.error}`, bad: true };
    } catch {
      outcome.value = { text: "NOT STOPPED: the server does not answer; use the stop at the robot", bad: true };
    }
    await new Promise((done) => setTimeout(done, AGAIN_MS));
  }
  stopping = false;
}

let escaped_ms = -Infinity;
addEventListener("keydown", (event) => {
  if (event.key !== "Escape" || event.repeat) return;
  if (event.timeStamp - escaped_ms < TWICE_MS && hello.value) stop();
  escaped_ms = event.timeStamp;
});

export function Stop() {
  const can = hello.value?.can_stop;
  const by = state.value?.stopped_by;
  const arm = () => {
    outcome.value = null;
    ask("arm", { stops: state.value?.stops }).catch((error: Error) => tell(error.message));
  };
  return (
    <div class="stop">
      <button type="button" class="halt" aria-keyshortcuts="Escape" onClick={stop} disabled={!can}
        title={can ? "writes the SAFE values; also Escape, twice" : "the spec has no SAFE values to write"}>
        STOP
      </button>
      {by && hello.value?.may_arm && <button type="button" onClick={arm}>go on</button>}
      <p role="status" class={outcome.value?.bad ? "bad" : ""}>
        {outcome.value?.bad ? outcome.value.text : by ? `stopped by ${by}` : outcome.value?.text ?? ""}
        {by && outcome.value && !outcome.value.bad && <span class="quiet"> {outcome.value.text}</span>}
      </p>
    </div>
  );
}
