// The last minutes of a live session, bounded in time and in bytes, as records of ../MESSAGES.md. It is kept in pieces of
// about a second; each begins with the whole surface, so that the oldest piece can go and the rest still plays.
import { encode_triangles, encode_whole, type Message } from "./messages";
import type { Session } from "./session";

export interface Limits {
  seconds: number;
  bytes: number;
}

interface Record {
  text: boolean;
  t: number;
  bytes: Uint8Array;
  topology: boolean;
}

interface Piece {
  t: number;
  bytes: number;
  records: Record[];
}

const kHeader = 16; // bytes before each record's own
const kPieceSeconds = 1;
const kFewestPieces = 16; // where pieces are as large as the limit lets them be

export class Recording {
  private scene_: Record | null = null;
  private topology_: Record | null = null; // the one that the first piece begins with
  private pieces_: Piece[] = [];
  private bytes_ = 0;
  private state_ = ""; // what the last one kept says of time: the same again, as while paused, is not kept

  constructor(private readonly limits_: Limits = { seconds: 120, bytes: 48e6 }) {}

  get seconds(): number {
    return this.pieces_.length ? this.last().records[this.last().records.length - 1].t - this.pieces_[0].t : 0;
  }

  get bytes(): number {
    return this.bytes_;
  }

  /** Keeps a message that the session has already taken. */
  add(data: string | ArrayBuffer, message: Message, session: Session): void {
    const text = typeof data === "string";
    const bytes = text ? new TextEncoder().encode(data) : new Uint8Array(data);
    const record = { text, t: session.t, bytes, topology: message.kind === "topology" };
    if (message.kind === "scene") {
      this.clear();
      this.scene_ = recorded(record);
    } else if (record.topology && this.pieces_.length === 0) {
      this.topology_ = record;
    } else if (this.scene_ && !this.said_before(message, session)) {
      this.begin_piece(session);
      if (this.pieces_.length) this.push(record);
    }
    this.trim();
  }

  private said_before(message: Message, session: Session): boolean {
    if (message.kind !== "state") return false;
    const before = this.state_;
    this.state_ = `${session.t} ${message.state.step} ${message.state.paused}`;
    return this.state_ === before;
  }

  clear(): void {
    this.state_ = "";
    this.pieces_ = [];
    this.bytes_ = 0;
    this.topology_ = null;
  }

  /** The records, one after another. */
  save(): Uint8Array {
    const first = this.pieces_.length ? this.pieces_[0].t : 0;
    const before = [this.scene_, this.topology_].filter((r) => r !== null).map((r) => ({ ...r, t: first }));
    return save_records([...before, ...this.pieces_.flatMap((piece) => piece.records)]);
  }

  private last(): Piece {
    return this.pieces_[this.pieces_.length - 1];
  }

  private begin_piece(session: Session): void {
    const { shape, t } = session;
    if (!shape?.known) return;
    const small = () => this.last().bytes < this.limits_.bytes / kFewestPieces;
    if (this.pieces_.length && t - this.last().t < kPieceSeconds && t >= this.last().t && small()) return;
    if (this.pieces_.length && t < this.last().t) this.pieces_ = [];
    if (this.pieces_.length === 0) this.bytes_ = 0;
    this.pieces_.push({ t, bytes: 0, records: [] });
    const { version, corners } = shape.topology;
    if (version > 1) this.push({ text: false, t, bytes: new Uint8Array(encode_triangles(version, corners)), topology: false });
    const whole = encode_whole(shape.topology.version, shape.step, shape.t, shape.q);
    this.push({ text: false, t, bytes: new Uint8Array(whole), topology: false });
  }

  private push(record: Record): void {
    this.last().records.push(record);
    this.last().bytes += record.bytes.length + kHeader;
    this.bytes_ += record.bytes.length + kHeader;
  }

  private trim(): void {
    while (this.pieces_.length > 1 && (this.seconds > this.limits_.seconds || this.bytes_ > this.limits_.bytes)) {
      const gone = this.pieces_.shift()!;
      this.bytes_ -= gone.bytes;
      this.topology_ = gone.records.filter((r) => r.topology).pop() ?? this.topology_;
    }
  }
}

/** The scene as whoever opens the recording sees it: nothing to control, nothing to choose. */
function recorded(scene: Record): Record {
  const json = JSON.parse(new TextDecoder().decode(scene.bytes));
  Object.assign(json.scene, { recorded: true, control: false, pausable: false, scenes: [] });
  return { ...scene, bytes: new TextEncoder().encode(JSON.stringify(json)) };
}

export function save_records(records: { text: boolean; t: number; bytes: Uint8Array }[]): Uint8Array {
  const out = new Uint8Array(records.reduce((sum, r) => sum + kHeader + r.bytes.length, 0));
  const view = new DataView(out.buffer);
  let at = 0;
  for (const { text, t, bytes } of records) {
    view.setUint32(at, bytes.length, true);
    view.setUint8(at + 4, text ? 0 : 1);
    view.setFloat64(at + 8, t, true);
    out.set(bytes, at + kHeader);
    at += kHeader + bytes.length;
  }
  return out;
}
