/** The page of `elitescript studio`. */

import { render } from "preact";
import { Page } from "./app/page.tsx";
import { Studio } from "./model/studio.ts";
import { WebSocketSource } from "./source/websocket.ts";
import "./style/page.css";

// The token stays in memory: the address bar, the history and links never show it.
const token = new URLSearchParams(location.search).get("token") ?? "";
history.replaceState(null, "", location.pathname);
const studio = new Studio(new WebSocketSource(`ws://${location.host}/socket?token=${encodeURIComponent(token)}`));
render(<Page studio={studio} />, document.getElementById("page")!);
studio.start();
