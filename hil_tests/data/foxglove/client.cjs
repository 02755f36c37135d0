const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const WebSocket = require("ws");
const [url, subprotocol, token] = process.argv.slice(2);
const found = { subprotocol: "", time: 0, signals: null, full: null, info: null, answers: [] };
const socket = new WebSocket(url, [subprotocol]);
const client = new FoxgloveClient({ ws: socket });
const readers = new Map();
client.on("open", () => { found.subprotocol = socket.protocol; });
client.on("error", (error) => { console.error(error); process.exit(1); });
client.on("serverInfo", (info) => { found.info = info; });
client.on("status", (status) => { found.status = status.message; });
client.on("advertise", (channels) => {
  found.channels = channels.length;
  for (const channel of channels) {
    if (!["/railhil/signals", "/full/TRN_SPEED"].includes(channel.topic)) continue;
    const reader = new MessageReader(parse(channel.schema, { ros2: true }));
    readers.set(client.subscribe(channel.id), [channel.topic, reader]);
  }
});
client.on("time", ({ timestamp }) => { found.time = Number(timestamp) / 1e9; });
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const [topic, reader] = readers.get(subscriptionId);
  const message = reader.readMessage(data);
  found[topic === "/railhil/signals" ? "signals" : "full"] = { at: Number(timestamp) / 1e9, ...message };
});
client.on("advertiseServices", ([service]) => {
  found.service = service.name;
  const writer = new MessageWriter(parse(service.request.schema, { ros2: true }));
  const reader = new MessageReader(parse(service.response.schema, { ros2: true }));
  ["wrong", token].forEach((word, at) => {
    const data = writer.writeMessage({ token: word, command: JSON.stringify({ do: "pause", id: at }) });
    client.sendServiceCallRequest({ serviceId: service.id, callId: at, encoding: "cdr", data: new DataView(data.buffer, data.byteOffset, data.byteLength) });
  });
  client.on("serviceCallResponse", ({ callId, data }) => { found.answers.push({ callId, ...reader.readMessage(data) }); });
});
setTimeout(() => { console.log(JSON.stringify(found)); process.exit(0); }, Number(process.argv[5] ?? 1500));
