"use strict";
const byId = (id) => document.getElementById(id);
let layout = null;
function connect() {
  const socket = new WebSocket(`ws://${location.host}/ws`, "railhil.panel.v1");
  socket.binaryType = "arraybuffer";
  socket.onopen = () => { byId("connection").textContent = "connected"; };
  socket.onclose = () => { byId("connection").textContent = "connection lost, trying again"; setTimeout(connect, 500); };
  socket.onmessage = (event) => {
    if (typeof event.data === "string") {
      const message = JSON.parse(event.data);
      if (message.header) { layout = message.header.layout; byId("title").textContent = message.header.runs[0].name; }
      return;
    }
    const [, , rows, columns] = new Uint32Array(event.data, 0, 4);
    if (!rows) return;
    const values = new Float32Array(event.data, 16 + 8 * rows, rows * columns);
    const last = (at) => values[at * rows + rows - 1];
    byId("gauges").textContent = [layout.speed, layout.target, layout.command].filter((at) => at >= 0)
      .map((at) => `${layout.columns[at].label} ${last(at).toFixed(2)} ${layout.columns[at].unit}`).join(" | ");
  };
}
connect();
