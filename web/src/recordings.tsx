// SPDX-License-Identifier: BSD-3-Clause
// Recordings on the server: begin and end one, save, replay and delete those that are there.
import { useEffect, useState } from "preact/hooks";
import { ask, hello, replay, state } from "./connection";
import { confirmed } from "./confirm";
import { tell } from "./messages";
import { playing, play, position_s, seek, speed, SPEEDS } from "./replayed";

interface Kept {
  name: string;
  size_bytes: number;
  changed_s: number;
}

const told = (error: Error) => tell(error.message);
const size = (bytes: number): string =>
  (bytes < 1e6 ? `${(bytes / 1e3).toFixed(0)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

export function Recordings() {
  const robot = hello.value;
  const now = state.value?.recording ?? null;
  const [kept, setKept] = useState<Kept[]>([]);
  const [open, setOpen] = useState(false);
  const [format, setFormat] = useState(".mcap");
  const [reading, setReading] = useState("");
  const load = async () => {
    try {
      const answer = await fetch("recordings");
      if (answer.ok) setKept(await answer.json());
      else tell(await answer.text());
    } catch {
      tell("the server does not answer");
    }
  };
  useEffect(() => {
    if (open) load();
  }, [open, now?.name]);
  if (!robot?.may_see_recordings) return null;
  const may = robot.writes.length > 0;
  const show = (name: string) => {
    setReading(name);
    ask("replay", { name }).catch(told).finally(() => setReading(""));
  };
  const remove = async (name: string) => {
    if (await confirmed(`Delete ${name}?`)) ask("delete_recording", { name }).then(load, told);
  };
  return (
    <details class="card recordings" onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>recordings {now && <span class="rec">● {now.name}</span>}</summary>
      <div class="tools">
        {may && !now && (
          <>
            <button type="button" onClick={() => ask("record", { format }).catch(told)}>
              <span class="rec" aria-hidden="true">●</span> record
            </button>
            <select aria-label="format of the recording" value={format}
              onChange={(event) => setFormat(event.currentTarget.value)}>
              <option value=".mcap">MCAP</option>
              <option value=".csv">CSV</option>
            </select>
          </>
        )}
        {may && now && (
          <button type="button" onClick={() => ask("end_recording").catch(told)}>■ end the recording</button>
        )}
        {!may && <span class="quiet">you may look, but not record</span>}
      </div>
      {now && (
        <p role="status">
          {now.by} records: {now.seconds.toFixed(0)} s, {now.samples} samples, {size(now.size_bytes)}
          {now.lost > 0 && <span class="alarm"> {now.lost} lost</span>}
        </p>
      )}
      <div class="wide" tabIndex={0} role="region" aria-label="kept recordings">
        <table>
          <tbody>
            {kept.filter((one) => one.name !== now?.name).map(({ name, size_bytes }) => (
              <tr key={name}>
                <th scope="row">{name}</th>
                <td>{size(size_bytes)}</td>
                <td>
                  <div class="tools">
                    <button type="button" aria-label={`replay ${name}`} disabled={!!reading}
                      onClick={() => show(name)}>{reading === name ? "reading …" : "replay"}</button>
                    <a class="button" href={`recordings/${name}`} download={name} aria-label={`save ${name}`}>save</a>
                    {robot.may_break && (
                      <button type="button" aria-label={`delete ${name}`} onClick={() => remove(name)}>×</button>
                    )}
                  </div>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </details>
  );
}

/** The buttons of the replay, and that it is one. */
export function Player() {
  const now = replay.value;
  if (!now) return null;
  const at = position_s.value;
  const moment = new Date((now.begun_s + at) * 1000);
  return (
    <section class="card player" aria-label="replay">
      <p role="status">
        <b>REPLAY, not live</b>: the charts show {now.name}. The values at the left are live.
        {now.notice && <span class="alarm"> {now.notice}</span>}
      </p>
      <div class="tools">
        <button type="button" onClick={() => play(!playing.value)}>{playing.value ? "pause" : "play"}</button>
        <input type="range" aria-label="place in the replay" min={0} max={now.duration_s}
          step={now.duration_s / 1000 || 1} value={at}
          aria-valuetext={`${at.toFixed(1)} of ${now.duration_s.toFixed(1)} s`}
          onInput={(event) => seek(Number(event.currentTarget.value))} />
        <span class="place">{at.toFixed(1)} of {now.duration_s.toFixed(1)} s, {moment.toLocaleTimeString()}</span>
        <select aria-label="speed of the replay" value={speed.value}
          onChange={(event) => (speed.value = Number(event.currentTarget.value))}>
          {SPEEDS.map((one) => <option key={one} value={one}>{one}×</option>)}
        </select>
        <button type="button" onClick={() => (replay.value = null)}>back to live</button>
      </div>
    </section>
  );
}
