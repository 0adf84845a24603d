// SPDX-License-Identifier: BSD-3-Clause
// The question before a write for which the spec says @confirm.
import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

const asked = signal<{ question: string; answer: (yes: boolean) => void } | null>(null);

/** Ask a person, and return whether the answer is yes. Without a question it is. */
export function confirmed(question: string | null): Promise<boolean> {
  if (!question) return Promise.resolve(true);
  return new Promise((done) => {
    asked.value?.answer(false);
    asked.value = { question, answer: done };
  });
}

export function Confirm() {
  const box = useRef<HTMLDialogElement>(null);
  const now = asked.value;
  useEffect(() => {
    if (now) box.current?.showModal();
    else box.current?.close();
  }, [now]);
  const end = (yes: boolean) => {
    asked.value?.answer(yes);
    asked.value = null;
  };
  return (
    <dialog ref={box} aria-labelledby="question" onClose={() => end(false)}>
      <p id="question">{now?.question}</p>
      <button type="button" onClick={() => end(true)}>yes</button>
      <button type="button" autofocus onClick={() => end(false)}>no</button>
    </dialog>
  );
}
