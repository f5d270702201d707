// What ONNX Runtime says of a network: node onnx_outputs.js FILE.onnx INPUTS.json
// INPUTS.json: {name: {"shape": [...], "numbers": [...]}}, float32. Prints the same of the network's outputs.
const fs = require('fs');
const ort = require('onnxruntime-node');

async function main(model, inputs) {
  const session = await ort.InferenceSession.create(model, {intraOpNumThreads: 1});
  const feeds = {};
  for (const [name, {shape, numbers}] of Object.entries(JSON.parse(fs.readFileSync(inputs, 'utf8')))) {
    feeds[name] = new ort.Tensor('float32', Float32Array.from(numbers), shape);
  }
  const outputs = {};
  for (const [name, tensor] of Object.entries(await session.run(feeds))) {
    outputs[name] = {shape: tensor.dims, numbers: Array.from(tensor.data)};
  }
  console.log(JSON.stringify(outputs));
}

main(process.argv[2], process.argv[3]).catch((error) => {
  console.error(error.message);
  process.exit(1);
});
