/** The page of `elitescript studio`. */

import { render } from "preact";
import { Page } from "./app/page.tsx";
import { Studio } from "./model/studio.ts";
import { WebSocketSource } from "./source/websocket.ts";
import "./style/page.css";

// The address bar, the history and links never show the token.
const token = new URLSearchParams(location.search).get("token") ?? "";
history.replaceState(null, "", location.pathname);
// For this tab alone, so that the page can be loaded again: the server's page that refuses takes it from there.
sessionStorage.setItem("elitescript-token", token);
const studio = new Studio(new WebSocketSource(`ws://${location.host}/socket?token=${encodeURIComponent(token)}`));
render(<Page studio={studio} />, document.getElementById("page")!);
studio.start();
