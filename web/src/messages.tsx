// SPDX-License-Identifier: BSD-3-Clause
// Short messages for the person at the page. A screen reader reads them at once.
import { signal } from "@preact/signals";

const SHOWN_MS = 8000;
const messages = signal<{ id: number; text: string }[]>([]);
let ids = 0;

export function tell(text: string): void {
  if (messages.value.some((one) => one.text === text)) return;
  const id = ++ids;
  messages.value = [...messages.value.slice(-3), { id, text }];
  setTimeout(() => drop(id), SHOWN_MS);
}

function drop(id: number): void {
  messages.value = messages.value.filter((one) => one.id !== id);
}

export function Messages() {
  return (
    <div class="messages" role="alert">
      {messages.value.map(({ id, text }) => (
        <p key={id}>
          {text} <button type="button" aria-label="close this message" onClick={() => drop(id)}>×</button>
        </p>
      ))}
    </div>
  );
}
