// SPDX-License-Identifier: BSD-3-Clause
// The robot in three dimensions, moved by its values, and the same in words.
import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { beat, drawn, hello, items, replay } from "./connection";
import { type Body, type Matrix, pose, poses, product, scaled, type Shape, tips, type Vector } from "./kinematics";
import { Ahead, position_s } from "./replayed";
import { type Colour, type Look, Scene, type Solid } from "./scene";
import { box, cylinder, sphere } from "./solids";

const FIRST = { yaw: -0.9, pitch: 0.5 };
const STEP_S = 0.02; // of the replay
const dark = matchMedia("(prefers-color-scheme: dark)");

const edges = (shape: Shape): number[] => {
  const [a = 1, b = 1, c = 1] = shape.size;
  if (shape.kind === "cylinder") return [a, a, b];
  return shape.kind === "sphere" ? [a, a, a] : [a, b, c];
};

export function RobotView() {
  const told = hello.value;
  const [body, setBody] = useState<Body | null>(null);
  const [wrong, setWrong] = useState("");
  useEffect(() => {
    if (!told?.has_body) return setBody(null);
    fetch("body").then(async (answer) => {
      if (answer.ok) setBody(await answer.json());
      else setWrong(await answer.text());
    }).catch(() => setWrong("the server does not answer"));
  }, [told?.has_body, told?.robot]);
  if (!told?.has_body) return null;
  return (
    <details class="card body" open>
      <summary>robot</summary>
      {wrong && <p class="alarm">{wrong}</p>}
      {body && <View body={body} />}
    </details>
  );
}

function View({ body }: { body: Body }) {
  const place = useRef<HTMLCanvasElement>(null);
  const [wrong, setWrong] = useState("");
  const look = useRef<Look>({ centre: [0, 0, 0], distance: 2, ...FIRST });
  const redraw = useRef<() => void>(() => undefined);
  const at = useRef<(joint: string) => number>(() => 0);
  const shownReplay = replay.value;

  useEffect(() => {
    const moved = Object.entries(body.moved);
    let series: ReturnType<Ahead["at"]> = null;
    const ahead = shownReplay && new Ahead(moved.map(([, one]) => one.item), STEP_S, () => redraw.current());
    at.current = (joint) => {
      const one = body.moved[joint];
      if (!one) return 0;
      const value = ahead ? series?.get(one.item)?.before(position_s.peek()) : items[one.item]?.value;
      return (value ?? 0) * one.factor;
    };
    if (!ahead) return;
    return effect(() => {
      series = ahead.at(position_s.value - 1, position_s.value);
      redraw.current();
    });
  }, [body, shownReplay]);

  useEffect(() => {
    const canvas = place.current;
    if (!canvas) return;
    const { centre, reach } = extent(body);
    look.current = { ...look.current, centre, distance: reach * 2.5 };
    let scene: Scene;
    try {
      scene = new Scene(canvas, 10 ** Math.floor(Math.log10(reach)) || 1);
    } catch (error) {
      setWrong(`${(error as Error).message}; the table has the joints`);
      return;
    }
    const solids: Record<string, Solid> = {
      box: scene.solid(box()),
      cylinder: scene.solid(cylinder()),
      sphere: scene.solid(sphere()),
    };
    let due = 0;
    let ended = false;
    const draw = () => {
      due = 0;
      if (!canvas.clientWidth || ended) return;
      const back: Colour = dark.matches ? [0.094, 0.129, 0.165, 1] : [1, 1, 1, 1];
      const line: Colour = dark.matches ? [0.25, 0.32, 0.38, 1] : [0.82, 0.86, 0.89, 1];
      scene.draw(look.current, back, line, parts(body, poses(body, at.current), solids));
    };
    redraw.current = () => {
      due ||= requestAnimationFrame(draw);
    };
    body.meshes.forEach((_, number) => {
      fetch(`body/${number}`).then(async (answer) => {
        if (!answer.ok) throw new Error();
        const corners = new Float32Array(await answer.arrayBuffer());
        if (!ended) solids[`mesh${number}`] = scene.solid(corners);
        redraw.current();
      }).catch(() => setWrong(`the mesh ${body.meshes[number]} did not come`));
    });
    const live = () => {
      if (!replay.peek()) redraw.current();
    };
    const lost = () => setWrong("the browser has lost its WebGL; load the page again");
    canvas.addEventListener("webglcontextlost", lost);
    drawn.add(live);
    const watch = new ResizeObserver(() => redraw.current());
    watch.observe(canvas);
    redraw.current();
    return () => {
      ended = true;
      drawn.delete(live);
      watch.disconnect();
      cancelAnimationFrame(due);
      canvas.removeEventListener("webglcontextlost", lost);
      scene.end();
    };
  }, [body]);

  const change = (yaw: number, pitch: number, zoom = 1) => {
    const now = look.current;
    now.yaw += yaw;
    now.pitch = Math.min(1.5, Math.max(-1.5, now.pitch + pitch));
    now.distance = Math.min(1e4, Math.max(0.01, now.distance * zoom));
    redraw.current();
  };
  const reset = () => {
    look.current = { ...look.current, ...FIRST, distance: extent(body).reach * 2.5 };
    redraw.current();
  };
  const keys: Record<string, () => void> = {
    ArrowLeft: () => change(-0.15, 0),
    ArrowRight: () => change(0.15, 0),
    ArrowUp: () => change(0, 0.1),
    ArrowDown: () => change(0, -0.1),
    "+": () => change(0, 0, 0.8),
    "-": () => change(0, 0, 1.25),
    Home: reset,
  };
  const press = (event: KeyboardEvent) => {
    const action = keys[event.key];
    if (action) event.preventDefault();
    action?.();
  };
  const drag = (event: PointerEvent) => {
    if (event.buttons !== 1) return;
    change(-event.movementX / 150, event.movementY / 150);
  };
  return (
    <>
      <canvas ref={place} class="robot" tabIndex={0} role="img" onKeyDown={press} onPointerMove={drag}
        onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
        aria-label={`${body.name}: arrows turn, plus and minus zoom, Home resets; the table below says the same`} />
      <div class="tools">
        <button type="button" aria-label="turn left" onClick={() => change(-0.3, 0)}>◀</button>
        <button type="button" aria-label="turn right" onClick={() => change(0.3, 0)}>▶</button>
        <button type="button" aria-label="closer" onClick={() => change(0, 0, 0.8)}>+</button>
        <button type="button" aria-label="farther" onClick={() => change(0, 0, 1.25)}>−</button>
        <button type="button" onClick={reset}>reset the view</button>
        {shownReplay && <span class="replayed">REPLAY</span>}
      </div>
      {wrong && <p class="alarm">{wrong}</p>}
      <Words body={body} at={(joint) => at.current(joint)} />
    </>
  );
}

/** The joints and the places of the tips, for those who do not see the picture, and for those who want numbers. */
function Words({ body, at }: { body: Body; at: (joint: string) => number }) {
  void beat.value;
  const moving = body.joints.filter((one) => ["revolute", "continuous", "prismatic"].includes(one.kind) && !one.mimic);
  const found = poses(body, at);
  const old = moving.some((one) => items[body.moved[one.name]?.item ?? -1]?.age.value) && !replay.value;
  return (
    <>
      {old && <p class="old">Values of joints are old: the robot may stand otherwise.</p>}
      <details>
        <summary>joints and tips in numbers</summary>
        <div class="wide" tabIndex={0} role="region" aria-label="joints and tips">
          <table>
            <tbody>
              {moving.map(({ name, kind }) => {
                const moved = body.moved[name];
                const text = kind === "prismatic" ? `${(at(name) * 1000).toFixed(1)} mm`
                  : `${((at(name) * 180) / Math.PI).toFixed(1)}°`;
                return (
                  <tr key={name}>
                    <th scope="row">{name}</th>
                    <td>{moved ? text : "does not move"}</td>
                    <td class="quiet">{moved?.path}</td>
                  </tr>
                );
              })}
              {tips(body).map((name) => (
                <tr key={`tip ${name}`}>
                  <th scope="row">{name}</th>
                  <td colSpan={2}>
                    at {found.get(name)?.slice(12, 15).map((one) => one.toFixed(3)).join(", ")} m
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      </details>
      {body.notes.map((note) => <p key={note} class="quiet">{note}</p>)}
    </>
  );
}

function* parts(
  body: Body, found: Map<string, Matrix>, solids: Record<string, Solid>,
): Generator<[Solid, Matrix, Colour]> {
  for (const link of body.links)
    for (const shape of link.shapes) {
      const solid = solids[shape.kind === "mesh" ? `mesh${shape.mesh}` : shape.kind];
      const place = found.get(link.name);
      if (!solid || !place) continue;
      yield [solid, product(product(place, pose(shape.xyz, shape.rpy)), scaled(edges(shape))), shape.colour];
    }
}

/** The middle of a robot and how far it reaches from there, with all joints at 0. Meshes count as points. */
function extent(body: Body): { centre: Vector; reach: number } {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const found = poses(body, () => 0);
  for (const link of body.links)
    for (const shape of [null, ...link.shapes]) {
      const place = found.get(link.name);
      if (!place) continue;
      const at = shape ? product(place, pose(shape.xyz, shape.rpy)) : place;
      const size = shape && shape.kind !== "mesh" ? Math.max(...edges(shape)) / 2 : 0;
      for (const axis of [0, 1, 2]) {
        low[axis] = Math.min(low[axis] ?? 0, (at[12 + axis] ?? 0) - size);
        high[axis] = Math.max(high[axis] ?? 0, (at[12 + axis] ?? 0) + size);
      }
    }
  const centre = [0, 1, 2].map((axis) => ((low[axis] ?? 0) + (high[axis] ?? 0)) / 2) as Vector;
  const reach = Math.max(0.05, Math.hypot(...[0, 1, 2].map((axis) => ((high[axis] ?? 0) - (low[axis] ?? 0)) / 2)));
  return { centre, reach };
}
