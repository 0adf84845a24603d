// SPDX-License-Identifier: BSD-3-Clause
// Draws a robot with WebGL. Each triangle has one brightness, by its side to the light.
import { camera, type Matrix, perspective, type Vector } from "./kinematics";

const VERTEX = `#version 300 es
in vec3 corner;
uniform mat4 model, view, projection;
out vec3 seen;
void main() {
  vec4 at = view * model * vec4(corner, 1.0);
  seen = at.xyz;
  gl_Position = projection * at;
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 seen;
uniform vec4 colour;
uniform float plain;
out vec4 drawn;
void main() {
  vec3 side = cross(dFdx(seen), dFdy(seen));
  float light = plain > 0.5 ? 1.0 : 0.4 + 0.6 * abs(dot(normalize(side), normalize(vec3(0.25, 0.5, 0.83))));
  drawn = vec4(colour.rgb * light, 1.0);
}`;
const GRID = 10; // lines of the floor each way

export interface Solid {
  buffer: WebGLBuffer;
  corners: number;
}

export interface Look {
  centre: Vector;
  distance: number;
  yaw: number;
  pitch: number;
}

export type Colour = [number, number, number, number];

/** A canvas with a scene. Throws an Error if the browser has no WebGL 2. */
export class Scene {
  private gl: WebGL2RenderingContext;
  private place: (name: string) => WebGLUniformLocation | null;
  private floor: Solid;

  constructor(private canvas: HTMLCanvasElement, private floor_m: number) {
    const gl = canvas.getContext("webgl2", { antialias: true, powerPreference: "low-power" });
    if (!gl) throw new Error("this browser has no WebGL 2");
    this.gl = gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]] as const) {
      const shader = gl.createShader(kind);
      if (!shader) throw new Error("WebGL was lost");
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "corner");
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(gl.getProgramInfoLog(program) ?? "WebGL was lost");
    gl.useProgram(program);
    gl.enableVertexAttribArray(0);
    gl.enable(gl.DEPTH_TEST);
    this.place = (name) => gl.getUniformLocation(program, name);
    const lines: number[] = [];
    for (let at = -GRID / 2; at <= GRID / 2; at++)
      for (const end of [-GRID / 2, GRID / 2]) lines.push(at, end, 0, at, -end, 0, end, at, 0, -end, at, 0);
    this.floor = this.solid(new Float32Array(lines));
  }

  solid(corners: Float32Array): Solid {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, corners, this.gl.STATIC_DRAW);
    return { buffer, corners: corners.length / 3 };
  }

  draw(look: Look, back: Colour, line: Colour, parts: Iterable<[Solid, Matrix, Colour]>): void {
    const { gl, canvas } = this;
    const ratio = Math.min(2, devicePixelRatio);
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(...back);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const { centre, distance, yaw, pitch } = look;
    gl.uniformMatrix4fv(this.place("projection"), false, perspective(width / height, distance / 50, distance * 20));
    gl.uniformMatrix4fv(this.place("view"), false, camera(centre, distance, yaw, pitch));
    const s = this.floor_m;
    this.part(this.floor, [s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0, 0, 0, 0, 1], line, gl.LINES);
    for (const [solid, model, colour] of parts) this.part(solid, model, colour, gl.TRIANGLES);
  }

  private part(solid: Solid, model: Matrix, colour: Colour, mode: number): void {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, solid.buffer);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.uniformMatrix4fv(this.place("model"), false, model);
    gl.uniform4fv(this.place("colour"), colour);
    gl.uniform1f(this.place("plain"), mode === gl.LINES ? 1 : 0);
    gl.drawArrays(mode, 0, solid.corners);
  }

  end(): void {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
