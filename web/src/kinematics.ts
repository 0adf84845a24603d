// SPDX-License-Identifier: BSD-3-Clause
// Where the links of a robot are, from the positions of its joints. Matrices have 16 numbers, column by column.

export type Matrix = number[];
export type Vector = [number, number, number];

export interface Shape {
  kind: "box" | "cylinder" | "sphere" | "mesh";
  size: number[];
  xyz: Vector;
  rpy: Vector;
  colour: [number, number, number, number];
  mesh: number;
}

export interface Joint {
  name: string;
  kind: string;
  parent: string;
  child: string;
  xyz: Vector;
  rpy: Vector;
  axis: Vector;
  mimic: { joint: string; multiplier: number; offset: number } | null;
}

/** The shape of a robot. Python's body.py writes it. */
export interface Body {
  name: string;
  links: { name: string; shapes: Shape[] }[];
  joints: Joint[];
  meshes: string[];
  moved: Record<string, { item: number; path: string; factor: number }>;
  notes: string[];
}

export const identity = (): Matrix => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function product(left: Matrix, right: Matrix): Matrix {
  const made = new Array<number>(16);
  for (let column = 0; column < 4; column++)
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let at = 0; at < 4; at++) sum += (left[4 * at + row] ?? 0) * (right[4 * column + at] ?? 0);
      made[4 * column + row] = sum;
    }
  return made;
}

/** A place and an orientation. Roll, pitch and yaw turn about the fixed axes x, y and z, in this order. */
export function pose([x, y, z]: Vector, [roll, pitch, yaw]: Vector): Matrix {
  const [sr, cr, sp, cp] = [Math.sin(roll), Math.cos(roll), Math.sin(pitch), Math.cos(pitch)];
  const [sy, cy] = [Math.sin(yaw), Math.cos(yaw)];
  return [
    cy * cp, sy * cp, -sp, 0,
    cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr, 0,
    cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr, 0,
    x, y, z, 1,
  ];
}

function turn([x, y, z]: Vector, angle: number): Matrix {
  const [s, c] = [Math.sin(angle), Math.cos(angle)];
  const t = 1 - c;
  return [
    t * x * x + c, t * x * y + s * z, t * x * z - s * y, 0,
    t * x * y - s * z, t * y * y + c, t * y * z + s * x, 0,
    t * x * z + s * y, t * y * z - s * x, t * z * z + c, 0,
    0, 0, 0, 1,
  ];
}

export function scaled([x = 1, y = 1, z = 1]: number[]): Matrix {
  return [x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0, 0, 0, 0, 1];
}

/** What moves within a joint, at a position in rad or m. */
function motion(joint: Joint, position: number): Matrix {
  if (joint.kind === "revolute" || joint.kind === "continuous") return turn(joint.axis, position);
  if (joint.kind !== "prismatic") return identity();
  const [x, y, z] = joint.axis;
  return pose([x * position, y * position, z * position], [0, 0, 0]);
}

/** The pose of each link, by its name. `position(name)` is that of a joint that does not mimic, in rad or m. */
export function poses(body: Body, position: (joint: string) => number): Map<string, Matrix> {
  const below = new Map<string, Joint[]>();
  for (const joint of body.joints) below.set(joint.parent, [...(below.get(joint.parent) ?? []), joint]);
  const children = new Set(body.joints.map((joint) => joint.child));
  const found = new Map<string, Matrix>();
  const waiting = body.links.filter((link) => !children.has(link.name)).map((link) => link.name);
  for (const name of waiting) found.set(name, identity());
  for (let name = waiting.pop(); name !== undefined; name = waiting.pop()) {
    const place = found.get(name) ?? identity();
    for (const joint of below.get(name) ?? []) {
      const { mimic } = joint;
      const at = mimic ? mimic.multiplier * position(mimic.joint) + mimic.offset : position(joint.name);
      found.set(joint.child, product(product(place, pose(joint.xyz, joint.rpy)), motion(joint, at)));
      waiting.push(joint.child);
    }
  }
  return found;
}

/** Links that hold no other link: hands, feet, tips. */
export function tips(body: Body): string[] {
  const parents = new Set(body.joints.map((joint) => joint.parent));
  return body.links.map((link) => link.name).filter((name) => !parents.has(name));
}

/** The projection of a camera with an angle of view of 40 degrees. */
export function perspective(aspect: number, near: number, far: number): Matrix {
  const f = 1 / Math.tan((20 * Math.PI) / 180);
  const depth = near - far;
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / depth, -1, 0, 0, (2 * far * near) / depth, 0];
}

/** What a camera sees that looks at a place from a distance. z is up; yaw turns about it, pitch raises the camera. */
export function camera([x, y, z]: Vector, distance: number, yaw: number, pitch: number): Matrix {
  const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
  const turned: Matrix = [-sy, -cy * sp, cy * cp, 0, cy, -sy * sp, sy * cp, 0, 0, cp, sp, 0, 0, 0, 0, 1];
  const moved = product(turned, pose([-x, -y, -z], [0, 0, 0]));
  moved[14] = (moved[14] ?? 0) - distance;
  return moved;
}
