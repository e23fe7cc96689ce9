/** A page of a sweep, with its data inside. */

import { render } from "preact";
import { fromBase64 } from "./source/recording.ts";
import { paint } from "./style/paint.ts";
import { readSweep } from "./sweep/data.ts";
import { Page } from "./sweep/page.tsx";
import { State } from "./sweep/state.ts";
import "./sweep/sweep.css";
import { text } from "./sweep/texts.ts";
import { speak } from "./text/language.ts";

const place = document.getElementById("page")!;
speak();

readSweep(fromBase64(document.getElementById("recording")!.textContent)).then((sweep) => {
  paint();
  place.replaceChildren();
  render(<Page state={new State(sweep)} />, place);
}).catch((error: unknown) => {
  place.textContent = text("unread", { why: error instanceof Error ? error.message : String(error) });
});
