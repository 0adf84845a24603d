// SPDX-License-Identifier: BSD-3-Clause
// What is drawn, which values are favourites, and which parts are folded. It stands in the URL, so a bookmark or a mail
// brings it back. It can also be saved in a file.
import { effect, signal } from "@preact/signals";

export interface Layout {
  id: number;
  paths: string[];
  window_s: number;
}

export const WINDOWS_S = [2, 5, 10, 30, 60, 300, 900, 3600];
const SERIES_MOST = 8;
const CHARTS_MOST = 30;

let ids = 0;
export const charts = signal<Layout[]>([]);
export const folded = signal<ReadonlySet<string>>(new Set());
export const favourites = signal<ReadonlySet<string>>(new Set()); // paths of items
export const active = signal(0); // the id of the chart that "plot" adds to

const windowOf = (wanted_s: unknown): number =>
  typeof wanted_s === "number" && WINDOWS_S.includes(wanted_s) ? wanted_s : 10;
const textsOf = (given: unknown): string[] =>
  Array.isArray(given) ? given.filter((one): one is string => typeof one === "string") : [];

/** Read the URL. Return the token that it brings, and take it out of the URL. */
export function readUrl(): string {
  const given = new URLSearchParams(location.hash.slice(1));
  const listed = (name: string) => (given.get(name) ?? "").split(",").filter(Boolean);
  charts.value = (given.get("charts") ?? "").split(";").filter(Boolean).map((text) => {
    const [paths = "", window_s = ""] = text.split("/");
    return {
      id: ++ids,
      paths: paths.split(",").filter(Boolean).slice(0, SERIES_MOST),
      window_s: windowOf(Number(window_s)),
    };
  });
  active.value = ids;
  folded.value = new Set(listed("folded"));
  favourites.value = new Set(listed("favourites"));
  const token = given.get("token") ?? "";
  if (token) writeUrl();
  return token;
}

function writeUrl(): void {
  const parts = [];
  const drawn = charts.value.map((one) => `${one.paths.join(",")}/${one.window_s}`).join(";");
  if (drawn) parts.push(`charts=${drawn}`);
  if (favourites.value.size) parts.push(`favourites=${[...favourites.value].join(",")}`);
  if (folded.value.size) parts.push(`folded=${[...folded.value].join(",")}`);
  history.replaceState(null, "", parts.length ? `#${parts.join("&")}` : location.pathname);
}

/** The layout as a text for a file. */
export function layoutText(robot: string): string {
  const drawn = charts.value.map(({ paths, window_s }) => ({ paths, window_s }));
  const [liked, shut] = [[...favourites.value], [...folded.value]];
  const layout = { unitylink_layout: 1, robot, charts: drawn, favourites: liked, folded: shut };
  return `${JSON.stringify(layout, null, 2)}\n`;
}

/** Take the layout of a file. Throws an Error that says what is wrong with it. */
export function takeLayout(text: string): void {
  let given: Record<string, unknown>;
  try {
    given = JSON.parse(text);
  } catch {
    throw new Error("the file is no layout: it is no JSON");
  }
  if (given?.unitylink_layout !== 1 || !Array.isArray(given.charts))
    throw new Error("the file is no layout that this page has saved");
  charts.value = given.charts.slice(0, CHARTS_MOST).map((one: Record<string, unknown> | null) => ({
    id: ++ids,
    paths: textsOf(one?.paths).slice(0, SERIES_MOST),
    window_s: windowOf(one?.window_s),
  }));
  active.value = ids;
  favourites.value = new Set(textsOf(given.favourites));
  folded.value = new Set(textsOf(given.folded));
}

export function keepUrl(): void {
  effect(writeUrl);
}

export function addChart(paths: string[] = []): void {
  charts.value = [...charts.value, { id: ++ids, paths, window_s: 10 }];
  active.value = ids;
}

export function change(id: number, to: Partial<Layout>): void {
  charts.value = charts.value.map((one) => (one.id === id ? { ...one, ...to } : one));
}

export function removeChart(id: number): void {
  charts.value = charts.value.filter((one) => one.id !== id);
  if (active.value === id) active.value = charts.value[charts.value.length - 1]?.id ?? 0;
}

/** Draw an item in a chart, or take it out if it is there. Without a chart, make one. */
export function toggle(path: string, id = active.value): void {
  const chart = charts.value.find((one) => one.id === id);
  if (!chart) return addChart([path]);
  const there = chart.paths.includes(path);
  if (!there && chart.paths.length >= SERIES_MOST) return addChart([path]);
  change(id, { paths: there ? chart.paths.filter((one) => one !== path) : [...chart.paths, path] });
}

export function favour(path: string): void {
  const now = new Set(favourites.value);
  if (!now.delete(path)) now.add(path);
  favourites.value = now;
}

export function fold(path: string, shut: boolean): void {
  const now = new Set(folded.value);
  if (shut) now.add(path);
  else now.delete(path);
  folded.value = now;
}
