// The WebSocket to the server that sent this page. Reconnects by itself, ever more patiently.

export type Link = "connecting" | "open" | "waiting";

export interface Ends {
  /** A message came. */
  message(data: string | ArrayBuffer): void;
  /** The link changed; `seconds`: when it is tried again, while waiting. */
  link(now: Link, seconds: number): void;
}

const kFirstWait = 0.5; // s
const kLongestWait = 8;

export class Connection {
  private socket_: WebSocket | null = null;
  private wait_ = kFirstWait;
  private number_ = 0;
  private stopped_ = false;

  constructor(private readonly token_: string, private readonly ends_: Ends) {
    this.open();
  }

  get is_open(): boolean {
    return this.socket_?.readyState === WebSocket.OPEN;
  }

  want(field: string | null): void {
    this.send({ want: { field } });
  }

  pause(paused: boolean): void {
    this.send({ pause: paused });
  }

  step(): void {
    this.send({ step: 1 });
  }

  /** Tells the server which surface was drawn, so that it never sends more than the page can draw. */
  shown(step: number): void {
    this.send({ shown: step });
  }

  choose(scene: string): void {
    this.send({ choose: scene });
  }

  pointer(tool: number, p: [number, number, number], buttons: number): void {
    // A place that cannot leave now is worth nothing later.
    if (this.socket_ && this.socket_.bufferedAmount > 4096) return;
    this.send({ pointer: { tool, p, buttons, number: ++this.number_ } });
  }

  /** For a page that plays what was recorded: no server is needed any more. */
  close(): void {
    this.stopped_ = true;
    this.socket_?.close();
  }

  private open(): void {
    this.ends_.link("connecting", 0);
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/live`, "palpate-view-1");
    socket.binaryType = "arraybuffer";
    this.socket_ = socket;
    socket.onopen = () => {
      this.wait_ = kFirstWait;
      this.send({ hello: { token: this.token_ } });
      this.ends_.link("open", 0);
    };
    socket.onmessage = (event) => this.ends_.message(event.data);
    socket.onclose = () => this.again();
  }

  private again(): void {
    if (this.stopped_) return;
    const seconds = this.wait_;
    this.wait_ = Math.min(kLongestWait, this.wait_ * 1.6);
    this.ends_.link("waiting", seconds);
    setTimeout(() => this.open(), seconds * 1000);
  }

  private send(message: object): void {
    if (this.is_open) this.socket_!.send(JSON.stringify(message));
  }
}

/** What gives this page control: `#token=...` at the end of its address. */
export function token_of(hash: string): string {
  return new URLSearchParams(hash.replace(/^#/, "")).get("token") ?? "";
}
