/** Says what has changed to screen readers: the state of the run, and problems. At most once a second. */

import { effect, useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import type { Studio } from "../model/studio.ts";
import { problemCount, runState } from "./state.ts";

const PAUSE_MS = 1000;

export function Announcer({ studio }: { studio: Studio }) {
  const said = useSignal("");
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    const stop = effect(() => {
      const state = runState(studio);
      const count = problemCount(studio);
      // What a computation has reached is not said: it changes all the time.
      const words = [state.text.includes(count) ? "" : count, state.kind === "busy" ? "" : state.text].filter(Boolean).join("; ");
      clearTimeout(timer);
      timer = setTimeout(() => (said.value = words), PAUSE_MS);
    });
    return () => {
      clearTimeout(timer);
      stop();
    };
  }, [studio]);
  return (
    <div class="unseen" aria-live="polite">
      {said}
    </div>
  );
}
