// SPDX-License-Identifier: BSD-3-Clause
// What is drawn and which parts are folded. It stands in the URL, so a bookmark or a mail brings it back.
import { effect, signal } from "@preact/signals";

export interface Layout {
  id: number;
  paths: string[];
  window_s: number;
}

export const WINDOWS_S = [2, 5, 10, 30, 60, 300, 900, 3600];
const SERIES_MOST = 8;

let ids = 0;
export const charts = signal<Layout[]>([]);
export const folded = signal<ReadonlySet<string>>(new Set());
export const active = signal(0); // the id of the chart that "plot" adds to

/** Read the URL. Return the token that it brings, and take it out of the URL. */
export function readUrl(): string {
  const given = new URLSearchParams(location.hash.slice(1));
  charts.value = (given.get("charts") ?? "").split(";").filter(Boolean).map((text) => {
    const [paths = "", window_s = ""] = text.split("/");
    const wanted_s = Number(window_s);
    return {
      id: ++ids,
      paths: paths.split(",").filter(Boolean).slice(0, SERIES_MOST),
      window_s: WINDOWS_S.includes(wanted_s) ? wanted_s : 10,
    };
  });
  active.value = ids;
  folded.value = new Set((given.get("folded") ?? "").split(",").filter(Boolean));
  const token = given.get("token") ?? "";
  if (token) writeUrl();
  return token;
}

function writeUrl(): void {
  const parts = [];
  const drawn = charts.value.map((one) => `${one.paths.join(",")}/${one.window_s}`).join(";");
  if (drawn) parts.push(`charts=${drawn}`);
  if (folded.value.size) parts.push(`folded=${[...folded.value].join(",")}`);
  history.replaceState(null, "", parts.length ? `#${parts.join("&")}` : location.pathname);
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

export function fold(path: string, shut: boolean): void {
  const now = new Set(folded.value);
  if (shut) now.add(path);
  else now.delete(path);
  folded.value = now;
}
