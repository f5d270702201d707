// usage: node read_events.js FOLDER
//
// Prints the last summary value of each tag in a folder's TensorBoard event files as JSON, and what the HParams page keeps with it, decoded
// by the definitions in tensorboard_events.proto; a field that is not in them is a fault.
"use strict";
const assert = require("assert");
const fs = require("fs");
const path = require("path");
const protobuf = require("protobufjs");

const root = protobuf.loadSync(path.join(__dirname, "tensorboard_events.proto"));

function decoded(name, bytes) {
  const type = root.lookupType(name);
  const message = type.decode(bytes);
  assert.strictEqual(type.encode(message).finish().length, bytes.length, `${name} with fields that nobody knows`);
  return type.toObject(message, { longs: Number, enums: String, bytes: Buffer, defaults: false });
}

function* records(bytes) {
  for (let at = 0; at < bytes.length; ) {
    const length = Number(bytes.readBigUInt64LE(at));
    yield bytes.subarray(at + 12, at + 12 + length);
    at += 16 + length;
  }
}

const tags = {};
for (const file of fs.readdirSync(process.argv[2]).filter((name) => name.includes("tfevents")).sort())
  for (const record of records(fs.readFileSync(path.join(process.argv[2], file)))) {
    const event = decoded("Event", record);
    for (const value of event.summary?.value ?? []) {
      if (value.metadata?.pluginData.pluginName === "hparams") value.hparams = decoded("HParamsPluginData", value.metadata.pluginData.content);
      if (value.tensor?.stringVal) value.text = value.tensor.stringVal.map(String);
      tags[value.tag] = { step: event.step ?? 0, ...value };
    }
  }
process.stdout.write(JSON.stringify(tags));
