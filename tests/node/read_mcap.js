// usage: node read_mcap.js indexed|stream FILE
//
// Reads an MCAP file as other programs do and prints it as JSON: by its index, or as a stream of what is there. Every message is decoded by
// the descriptors in the file, and those of package foxglove also by Foxglove's own, which must say the same.
"use strict";
const assert = require("assert");
const fs = require("fs");
const path = require("path");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const zstd = require("@foxglove/wasm-zstd");
const protobuf = require("protobufjs");
const { FileDescriptorSet } = require("protobufjs/ext/descriptor");

const kPublished = path.join(path.dirname(require.resolve("@foxglove/schemas/package.json")), "schemas/proto");
const kAsText = { defaults: true, longs: String, enums: String, bytes: String, oneofs: false };

function publishedType(name) {
  const root = new protobuf.Root();
  root.resolvePath = (origin, target) => (path.isAbsolute(target) ? target : path.join(kPublished, target));
  root.loadSync(path.join(kPublished, name.replace(".", "/") + ".proto"), { keepCase: true });
  return root.lookupType(name);
}

/** Every field that Foxglove has must be here under its number, and no other. */
function checkAgainstPublished(type, published) {
  const fields = (of) => Object.fromEntries(of.fieldsArray.map((field) => [field.name, [field.id, field.type.replace(/^.*\./, "")]]));
  assert.deepStrictEqual(fields(type), fields(published), type.fullName);
  for (const field of type.fieldsArray) {
    field.resolve();
    published.fields[field.name].resolve();
    if (field.resolvedType instanceof protobuf.Type) checkAgainstPublished(field.resolvedType, published.fields[field.name].resolvedType);
    if (field.resolvedType instanceof protobuf.Enum)
      assert.deepStrictEqual({ ...field.resolvedType.values }, { ...published.fields[field.name].resolvedType.values });
  }
}

class Decoder {
  constructor() {
    this.types = new Map();
    this.topics = new Map();
  }
  addSchema(schema) {
    if (this.types.has(schema.id)) return;
    assert.strictEqual(schema.encoding, "protobuf");
    const type = protobuf.Root.fromDescriptor(FileDescriptorSet.decode(schema.data)).lookupType(schema.name);
    const published = schema.name.startsWith("foxglove.") ? publishedType(schema.name) : undefined;
    if (published) checkAgainstPublished(type, published);
    this.types.set(schema.id, { name: schema.name, type, published });
  }
  addChannel(channel) {
    assert.strictEqual(channel.messageEncoding, "protobuf");
    this.topics.set(channel.id, { topic: channel.topic, ...this.types.get(channel.schemaId) });
  }
  message(record) {
    const { topic, name, type, published } = this.topics.get(record.channelId);
    const message = type.toObject(type.decode(record.data), kAsText);
    if (published) assert.deepStrictEqual(message, published.toObject(published.decode(record.data), kAsText));
    return { topic, schema: name, time_ns: String(record.logTime), sequence: record.sequence, message };
  }
}

async function readIndexed(file, decompressHandlers) {
  const handle = await fs.promises.open(file);
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, length) => {
      const buffer = new Uint8Array(Number(length));
      const { bytesRead } = await handle.read(buffer, 0, buffer.length, Number(offset));
      assert.strictEqual(bytesRead, buffer.length);
      return buffer;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const decoder = new Decoder();
  for (const schema of reader.schemasById.values()) decoder.addSchema(schema);
  for (const channel of reader.channelsById.values()) decoder.addChannel(channel);
  const messages = [];
  for await (const record of reader.readMessages({ validateCrcs: true })) messages.push(decoder.message(record));
  const metadata = {};
  for await (const record of reader.readMetadata()) metadata[record.name] = Object.fromEntries(record.metadata);
  const statistics = { messages: Number(reader.statistics.messageCount), chunks: reader.statistics.chunkCount };
  assert.strictEqual(reader.chunkIndexes.length, statistics.chunks);
  assert.strictEqual(messages.length, statistics.messages);
  for (const [id, count] of reader.statistics.channelMessageCounts)
    assert.strictEqual(BigInt(messages.filter((m) => m.topic === reader.channelsById.get(id).topic).length), count);
  await handle.close();
  return { messages, metadata, whole: true, chunks: statistics.chunks };
}

function readStream(file, decompressHandlers) {
  const reader = new McapStreamReader({ decompressHandlers, includeChunks: true, validateCrcs: true });
  const decoder = new Decoder();
  const messages = [];
  const metadata = {};
  let chunks = 0;
  reader.append(fs.readFileSync(file));
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") decoder.addSchema(record);
    if (record.type === "Channel") decoder.addChannel(record);
    if (record.type === "Message") messages.push(decoder.message(record));
    if (record.type === "Metadata") metadata[record.name] = Object.fromEntries(record.metadata);
    if (record.type === "Chunk") ++chunks;
  }
  return { messages, metadata, whole: reader.done(), chunks };
}

(async () => {
  const [how, file] = process.argv.slice(2);
  await zstd.isLoaded;
  const decompressHandlers = { zstd: (bytes, size) => zstd.decompress(bytes, Number(size)) };
  const read = how === "indexed" ? await readIndexed(file, decompressHandlers) : readStream(file, decompressHandlers);
  process.stdout.write(JSON.stringify(read));
})().catch((error) => {
  console.error(error);
  process.exit(1);
});
