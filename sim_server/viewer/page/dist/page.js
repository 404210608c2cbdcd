"use strict";
// Stands here until the page itself is built: vertices as dots, the state as text.
const token = (location.hash.match(/token=([0-9a-f]+)/) || [])[1] || "";
const socket = new WebSocket(`ws://${location.host}/live`, "palpate-view-1");
socket.binaryType = "arraybuffer";
let n = 0, box = null, q = null, frames = 0;
socket.onopen = () => socket.send(JSON.stringify({ hello: { token } }));
socket.onmessage = ({ data }) => {
  if (typeof data === "string") {
    const message = JSON.parse(data);
    if (message.state) document.getElementById("state").textContent = `${frames} frames ` + data;
    return;
  }
  const view = new DataView(data), kind = view.getUint8(0);
  if (kind === 1) n = view.getUint32(8, true), box = new Float32Array(data, 16, 6), q = new Uint16Array(3 * n);
  if (kind !== 2) return;
  const k = view.getUint32(20, true), whole = view.getUint32(24, true);
  const numbers = whole ? null : new Uint32Array(data, 28, k), places = new Uint16Array(data, 28 + (whole ? 0 : 4 * k), 3 * k);
  for (let i = 0; i < k; ++i) q.set(places.subarray(3 * i, 3 * i + 3), 3 * (numbers ? numbers[i] : i));
  ++frames;
  const canvas = document.getElementById("view"), context = canvas.getContext("2d");
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = "#e88";
  for (let v = 0; v < n; ++v) context.fillRect(q[3 * v] / 65535 * canvas.width, canvas.height - q[3 * v + 1] / 65535 * canvas.height, 2, 2);
};
