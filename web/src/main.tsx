// SPDX-License-Identifier: BSD-3-Clause
// The page: the stop and alarms above, values beside charts, recordings, the link and events below.
import { render } from "preact";
import { useState } from "preact/hooks";
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { AlarmCount, Alarms } from "./alarms";
import { RobotView } from "./body";
import { Charts } from "./charts";
import { Confirm } from "./confirm";
import { connect, hello, items, logIn, logOut, phase, reason } from "./connection";
import { Control } from "./control";
import { Drafts } from "./drafts";
import { Groups } from "./groups";
import { Health, Pulse } from "./health";
import { charts, keepUrl, readUrl } from "./layout";
import { Log } from "./log";
import { Messages } from "./messages";
import { Player, Recordings } from "./recordings";
import { Stop } from "./stop";
import { Favourites, Tree } from "./tree";

function Page() {
  const robot = hello.value;
  if (phase.value === "login") return <LogIn />;
  if (!robot) return <main class="wait"><p role="status">connecting … {reason}</p></main>;
  return (
    <>
      <header>
        <h1>{robot.robot}</h1>
        <Pulse />
        <AlarmCount />
        <Stop />
      </header>
      {phase.value === "lost" && (
        <p class="lost" role="alert">⚠ no connection to the server: {reason}. All values are old.</p>
      )}
      <main>
        <section class="left" aria-label="values">
          <Control />
          <Alarms />
          <Favourites />
          <Tree />
          <Groups />
          <p class="quiet who">
            {robot.user} {robot.has_status && <a href="/status">status</a>}{" "}
            <button type="button" onClick={logOut}>log out</button>
          </p>
        </section>
        <section class="drawn" aria-label="charts">
          <Player />
          <RobotView />
          <Charts />
        </section>
        <section class="below" aria-label="recordings, link and events">
          <Recordings />
          <Health />
          <Log />
        </section>
      </main>
      <Drafts />
      <Messages />
      <Confirm />
    </>
  );
}

function LogIn() {
  const [wrong, setWrong] = useState(reason.value);
  const send = (event: SubmitEvent) => {
    event.preventDefault();
    const token = String(new FormData(event.currentTarget as HTMLFormElement).get("token")).trim();
    logIn(token).catch((error: Error) => setWrong(error.message));
  };
  return (
    <main class="login">
      <h1>Unity-Link</h1>
      <form onSubmit={send}>
        <label for="token">Token, as the server has printed it</label>
        <input id="token" name="token" type="password" autocomplete="current-password" required />
        <button type="submit">log in</button>
        <p role="alert">{wrong}</p>
      </form>
    </main>
  );
}

const token = readUrl();
keepUrl();
const stopFirstChart = hello.subscribe((robot) => {
  if (!robot) return;
  document.title = `Unity-Link: ${robot.robot}`;
  queueMicrotask(() => stopFirstChart());
  const published = items.filter((item) => item.rate_hz > 0 && item.facts.kind === "number");
  const unit = published[0]?.facts.unit;
  const alike = published.filter((item) => item.facts.unit === unit && item.facts.name === published[0]?.facts.name);
  if (!charts.value.length && alike.length)
    charts.value = [{ id: 1e6, paths: alike.slice(0, 4).map((item) => item.facts.path), window_s: 10 }];
});
if (token) {
  logIn(token).catch((error: Error) => {
    reason.value = error.message;
    phase.value = "login";
  });
} else connect();
render(<Page />, document.body);
