// Writes a recording by @mcap/core, which others write theirs by: mcap_npm.mjs FILE COMPRESSION, with the messages as JSON on standard
// input: [{"topic", "type", "time" in ns as text, "data" in base64}]. COMPRESSION is none or zstd.
import fs from "node:fs";
import { McapWriter } from "@mcap/core";
import zstd from "@foxglove/wasm-zstd";

const [file, compression] = process.argv.slice(2);
const parts = [];
let size = 0n;
const writable = {
  write: async (bytes) => { parts.push(Buffer.from(bytes)); size += BigInt(bytes.byteLength); },
  position: () => size,
};
await zstd.isLoaded;
const compressChunk = compression === "zstd"
  ? (bytes) => ({ compression: "zstd", compressedData: zstd.compress(bytes, 3) }) : undefined;
const writer = new McapWriter({ writable, compressChunk, chunkSize: 20000 });
await writer.start({ profile: "ros2", library: "npm" });
const channels = new Map();
for (const { topic, type, time, data } of JSON.parse(fs.readFileSync(0))) {
  if (!channels.has(topic)) {
    const schemaId = await writer.registerSchema({ name: type, encoding: "ros2msg", data: new Uint8Array() });
    channels.set(topic, await writer.registerChannel({ schemaId, topic, messageEncoding: "cdr", metadata: new Map() }));
  }
  const logTime = BigInt(time);
  await writer.addMessage({ channelId: channels.get(topic), sequence: 0, logTime, publishTime: logTime, data: Buffer.from(data, "base64") });
}
await writer.end();
fs.writeFileSync(file, Buffer.concat(parts));
