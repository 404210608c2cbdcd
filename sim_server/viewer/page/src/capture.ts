// What one takes away from the page: a picture, a video, and the last minutes in one HTML file.
import { note, save_file } from "./dom";

/** Names files after the scene and the moment. */
export function file_name(title: string, end: string): string {
  const words = title.toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^_|_$/g, "") || "palpate";
  const moment = new Date().toISOString().slice(0, 19).replace(/[-:]/g, "").replace("T", "_");
  return `${words}_${moment}.${end}`;
}

/** What a picture says of itself. */
export interface Caption {
  title: string; // what, and when
  measure: string; // with its unit; empty: no ramp
  top: string; // what the end of the ramp stands for
  colour: string; // of the words
}

/** Saves what the canvas shows now, with its legend. */
export function take_picture(canvas: HTMLCanvasElement, name: string, caption: Caption): void {
  const copy = document.createElement("canvas");
  copy.width = canvas.width;
  copy.height = canvas.height;
  const context = copy.getContext("2d")!;
  context.drawImage(canvas, 0, 0);
  const scale = canvas.width / canvas.clientWidth;
  context.scale(scale, scale);
  write_caption(context, caption, 16, canvas.clientHeight - 16);
  copy.toBlob((blob) => (blob ? save_file(name, blob) : note("The browser gave no picture.")), "image/png");
}

function write_caption(context: CanvasRenderingContext2D, caption: Caption, left: number, bottom: number): void {
  const width = 220;
  context.font = "13px system-ui, sans-serif";
  context.fillStyle = caption.colour;
  context.fillText(caption.title, left, caption.measure ? bottom - 56 : bottom);
  if (!caption.measure) return;
  context.font = "12px system-ui, sans-serif";
  context.fillText(caption.measure, left, bottom - 34);
  context.fillText("0", left, bottom);
  context.textAlign = "right";
  context.fillText(caption.top, left + width, bottom);
  context.drawImage(document.getElementById("ramp") as HTMLCanvasElement, left, bottom - 24, width, 8);
}

/** Films the canvas until told to stop. */
export class Video {
  private recorder_: MediaRecorder | null = null;

  get running(): boolean {
    return this.recorder_ !== null;
  }

  start(canvas: HTMLCanvasElement, name: (end: string) => string): boolean {
    const kinds = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
    const kind = typeof MediaRecorder === "undefined" ? undefined : kinds.find((k) => MediaRecorder.isTypeSupported(k));
    if (!kind) {
      note("This browser cannot record a video.");
      return false;
    }
    const recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: kind, videoBitsPerSecond: 6e6 });
    recorder.ondataavailable = (event) => save_file(name(kind.includes("mp4") ? "mp4" : "webm"), event.data);
    recorder.start(); // in one piece: of several, Firefox may give the first one last
    this.recorder_ = recorder;
    return true;
  }

  stop(): void {
    this.recorder_?.stop();
    this.recorder_?.stream.getTracks().forEach((track) => track.stop());
    this.recorder_ = null;
  }
}

const kPolicy =
  "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src blob: data:; media-src blob:";

/** This page with a session inside: it opens from the disk, and asks nobody for anything. */
export async function shared_page(session: Uint8Array): Promise<Blob> {
  const [html, script, style] = await Promise.all(["index.html", "page.js", "page.css"].map(get));
  const policy = `<meta http-equiv="Content-Security-Policy" content="${kPolicy}">`;
  const data = `<script type="text/plain" id="session">${await pack(session)}</` + "script>";
  const program = `<script>${script.replaceAll("</script", "<\\/script")}</` + "script>";
  const whole = html
    .replace('<meta charset="utf-8">', (tag) => `${tag}\n${policy}`)
    .replace(/<link rel="stylesheet"[^>]*>/, () => `<style>${style}</style>`)
    .replace(/<script src="page.js"[^>]*><\/script>/, () => `${data}\n${program}`);
  return new Blob([whole], { type: "text/html" });
}

async function get(name: string): Promise<string> {
  const answer = await fetch(name);
  if (!answer.ok) throw new Error(`${name}: ${answer.status}`);
  return answer.text();
}

/** Compressed, in base 64. */
export async function pack(bytes: Uint8Array): Promise<string> {
  const packed = await through(bytes, new CompressionStream("gzip"));
  let text = "";
  for (let at = 0; at < packed.length; at += 0x8000) text += String.fromCharCode(...packed.subarray(at, at + 0x8000));
  return btoa(text);
}

export async function unpack(text: string): Promise<ArrayBuffer> {
  const packed = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
  return (await through(packed, new DecompressionStream("gzip"))).buffer as ArrayBuffer;
}

async function through(bytes: Uint8Array, stream: GenericTransformStream): Promise<Uint8Array> {
  const source = new Blob([bytes as Uint8Array<ArrayBuffer>]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(source).arrayBuffer());
}
