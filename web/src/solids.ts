// SPDX-License-Identifier: BSD-3-Clause
// Triangles of solids of the size 1: a box, a cylinder about z, a sphere. Nine numbers each.

const AROUND = 24;

export function box(): Float32Array {
  const found: number[] = [];
  for (const axis of [0, 1, 2])
    for (const side of [-0.5, 0.5]) {
      const corner = (u: number, v: number): number[] => {
        const at = [0, 0, 0];
        at[axis] = side;
        at[(axis + 1) % 3] = u;
        at[(axis + 2) % 3] = v;
        return at;
      };
      square(found, corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5));
    }
  return new Float32Array(found);
}

/** With the radius 1 and the length 1. */
export function cylinder(): Float32Array {
  const found: number[] = [];
  for (let at = 0; at < AROUND; at++) {
    const [a, b] = [ring(at), ring(at + 1)];
    square(found, [...a, -0.5], [...b, -0.5], [...b, 0.5], [...a, 0.5]);
    for (const end of [-0.5, 0.5]) found.push(0, 0, end, ...a, end, ...b, end);
  }
  return new Float32Array(found);
}

/** With the radius 1. */
export function sphere(): Float32Array {
  const found: number[] = [];
  const rows = AROUND / 2;
  const at = (row: number, column: number): number[] => {
    const up = (Math.PI * row) / rows - Math.PI / 2;
    const [x, y] = ring(column);
    return [x * Math.cos(up), y * Math.cos(up), Math.sin(up)];
  };
  for (let row = 0; row < rows; row++)
    for (let column = 0; column < AROUND; column++)
      square(found, at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column));
  return new Float32Array(found);
}

function ring(at: number): [number, number] {
  const angle = (2 * Math.PI * at) / AROUND;
  return [Math.cos(angle), Math.sin(angle)];
}

function square(to: number[], a: number[], b: number[], c: number[], d: number[]): void {
  to.push(...a, ...b, ...c, ...a, ...c, ...d);
}
