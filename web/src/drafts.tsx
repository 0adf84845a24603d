// SPDX-License-Identifier: BSD-3-Clause
// Values that have been typed in several boxes, to be written together: one burst, and one commit where there is one.
import { items } from "./connection";
import { tell } from "./messages";
import type { Item } from "./model";
import { drafts, parsed, setDraft, write } from "./setter";

export function Drafts() {
  const typed = [...drafts.value];
  if (typed.length < 2) return null;
  const together = () => {
    try {
      const values = typed.map(([path, text]): [Item, unknown] => {
        const item = items.find((one) => one.facts.path === path);
        if (!item) throw new Error(`${path} is not there any more`);
        return [item, parsed(item, text)];
      });
      write(values);
    } catch (error) {
      tell((error as Error).message);
    }
  };
  const forget = () => typed.forEach(([path]) => setDraft(path, null));
  return (
    <div class="drafts" role="region" aria-label="values to be written together">
      <span>{typed.map(([path, text]) => `${path} = ${text}`).join(", ")}</span>
      <button type="button" onClick={together}>write {typed.length} together</button>
      <button type="button" onClick={forget}>forget them</button>
    </div>
  );
}
