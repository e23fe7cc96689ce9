/** A page of one recorded run, with the recording inside. */

import { render } from "preact";
import { Page } from "./app/page.tsx";
import { Studio } from "./model/studio.ts";
import { RecordedSource } from "./source/recorded.ts";
import "./style/page.css";

const studio = new Studio(new RecordedSource([]));
render(<Page studio={studio} />, document.getElementById("page")!);
studio.start();
