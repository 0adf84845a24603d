// SPDX-License-Identifier: BSD-3-Clause
// Who controls which part of the robot, and the button to take control.
import { useState } from "preact/hooks";
import { ask, held, hello, state } from "./connection";
import { confirmed } from "./confirm";
import { tell } from "./messages";

const told = (error: Error) => tell(error.message);
const shown = (part: string) => part || "the whole robot";
const overlap = (one: string, other: string) => !one || !other || `${one}.`.startsWith(`${other}.`)
  || `${other}.`.startsWith(`${one}.`);
/** Who wants what this lease holds, for example "ben". */
const wanting = (part: string) =>
  [...new Set((state.value?.wishes ?? []).filter((one) => overlap(one.part, part)).map((one) => one.user))].join(", ");

export function Control() {
  const robot = hello.value;
  const parts = robot?.writes.includes("") ? ["", ...robot.tree.parts.map((one) => one.path)] : robot?.writes ?? [];
  const [part, setPart] = useState(parts[0] ?? "");
  if (!robot) return null;
  const leases = state.value?.leases ?? [];
  const take = async () => {
    // outputs that are being made safe are so in a moment
    for (let waits = 0; waits < 30 && state.value?.leases.some((one) => one.ending); waits++)
      await new Promise((done) => setTimeout(done, 100));
    ask("take", { part }).catch(told);
  };
  const release = (one: string) => ask("release", { part: one }).catch(told);
  const want = (one: string) => ask("ask", { part: one }).catch(told);
  const seize = async (one: string, holder: string) => {
    const question = `Take ${shown(one)} away from ${holder}? Its outputs get their SAFE values.`;
    if (await confirmed(question)) ask("break", { part: one }).catch(told);
  };
  return (
    <div class="control">
      {parts.length === 0 ? <span class="quiet">you may look, but not write</span> : (
        <>
          {parts.length > 1 && (
            <select aria-label="part to control" value={part} onChange={(event) => setPart(event.currentTarget.value)}>
              {parts.map((one) => <option key={one} value={one}>{shown(one)}</option>)}
            </select>
          )}
          <button type="button" onClick={take} disabled={held.value.includes(part)}>take control</button>
        </>
      )}
      <div aria-label="who controls what" role="status"><ul>
        {leases.map((one) => (
          <li key={one.part}>
            <b>{shown(one.part)}</b>: {one.ending ? `being made safe, ${one.holder} lost it`
              : one.client === robot.client ? "you" : one.holder}
            {!one.ending && wanting(one.part) && <em> ({wanting(one.part)} wants it)</em>}
            {one.client === robot.client && !one.ending && (
              <button type="button" onClick={() => release(one.part)}>give back</button>
            )}
            {one.client !== robot.client && !one.ending && parts.length > 0 && (
              <button type="button" onClick={() => want(one.part)}>ask for it</button>
            )}
            {one.client !== robot.client && robot.may_break && !one.ending && (
              <button type="button" onClick={() => seize(one.part, one.holder)}>take away</button>
            )}
          </li>
        ))}
      </ul></div>
    </div>
  );
}
