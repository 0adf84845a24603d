// SPDX-License-Identifier: BSD-3-Clause
// The layout as a file, which others can load.
import { useRef } from "preact/hooks";
import { hello } from "./connection";
import { layoutText, takeLayout } from "./layout";
import { tell } from "./messages";

const BYTES_MOST = 200_000;

export function LayoutFile() {
  const picker = useRef<HTMLInputElement>(null);
  const save = () => {
    const robot = hello.value?.robot ?? "robot";
    const url = URL.createObjectURL(new Blob([layoutText(robot)], { type: "application/json" }));
    const link = document.createElement("a");
    link.href = url;
    link.download = `${robot}-layout.json`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  };
  const load = async (box: HTMLInputElement) => {
    const file = box.files?.[0];
    try {
      if (file && file.size > BYTES_MOST) throw new Error("the file is no layout: it is too long");
      if (file) takeLayout(await file.text());
    } catch (error) {
      tell((error as Error).message);
    }
    box.value = ""; // so that the same file can be taken again
  };
  return (
    <>
      <button type="button" onClick={save}>save layout</button>
      <button type="button" onClick={() => picker.current?.click()}>load layout</button>
      <input ref={picker} type="file" accept=".json,application/json" hidden aria-label="file with a layout"
        onChange={(event) => load(event.currentTarget)} />
    </>
  );
}
