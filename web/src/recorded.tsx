/** A page of a recorded run, with the recording inside; a second run in it is laid over the first. */

import { render } from "preact";
import { Page } from "./app/page.tsx";
import { runOf, titleOf } from "./model/compare.ts";
import { Studio } from "./model/studio.ts";
import { RecordedSource } from "./source/recorded.ts";
import { fromBase64, readRecording } from "./source/recording.ts";
import "./style/page.css";
import { text } from "./text/text.ts";

const place = document.getElementById("page")!;

readRecording(fromBase64(document.getElementById("recording")!.textContent)).then(([first, second]) => {
  if (first === undefined) throw new Error("no run in the recording");
  const studio = new Studio(new RecordedSource(first));
  place.replaceChildren();
  render(<Page studio={studio} />, place);
  studio.start();
  // What ended in an alarm is opened there.
  const alarm = studio.run.value?.alarm;
  if (alarm != null) studio.jump(alarm.t, alarm);
  if (second !== undefined) studio.compareWith(runOf(second), titleOf(second));
}).catch((error: unknown) => {
  place.textContent = text("recording_unread", { why: error instanceof Error ? error.message : String(error) });
});
