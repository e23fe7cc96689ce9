/** A source at the other end of a WebSocket: text messages are JSON, binary ones are rows. Connects again by itself. */

import type { FromSource, ToSource } from "./messages.ts";
import { readRows } from "./rows.ts";
import type { Listener, Source } from "./source.ts";

const PAUSE_FIRST_MS = 250;
const PAUSE_LONGEST_MS = 5000;

export class WebSocketSource implements Source {
  private readonly address: string;
  private socket: WebSocket | null = null;
  private listener: Listener | null = null;
  private pause_ms = PAUSE_FIRST_MS;
  private isClosed = false;

  constructor(address: string) {
    this.address = address;
  }

  start(listener: Listener): void {
    this.listener = listener;
    this.connect();
  }

  send(message: ToSource): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  close(): void {
    this.isClosed = true;
    this.socket?.close();
  }

  private connect(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.pause_ms = PAUSE_FIRST_MS;
      this.listener?.linked("open");
    };
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === "string") this.listener?.message(JSON.parse(data) as FromSource);
      else this.listener?.rows(readRows(data));
    };
    socket.onclose = () => {
      if (this.isClosed || this.socket !== socket) return;
      this.listener?.linked("lost");
      setTimeout(() => this.connect(), this.pause_ms);
      this.pause_ms = Math.min(2 * this.pause_ms, PAUSE_LONGEST_MS);
    };
  }
}
