// What ONNX Runtime says of a network step by step: node onnx_steps.js FILE.onnx STEPS.json
// STEPS.json: [{name: {"shape": [...], "numbers": [...]}}, ...], float32. What the network gives as next_NAME it takes as NAME
// at the next step, unless that is given. Prints the same of the network's outputs.
const fs = require('fs');
const ort = require('onnxruntime-node');

async function main(model, file) {
  const session = await ort.InferenceSession.create(model, {intraOpNumThreads: 1});
  const feeds = {};
  const results = [];
  for (const step of JSON.parse(fs.readFileSync(file, 'utf8'))) {
    for (const [name, {shape, numbers}] of Object.entries(step)) {
      feeds[name] = new ort.Tensor('float32', Float32Array.from(numbers), shape);
    }
    const outputs = {};
    for (const [name, tensor] of Object.entries(await session.run(feeds))) {
      outputs[name] = {shape: tensor.dims, numbers: Array.from(tensor.data)};
      if (name.startsWith('next_')) feeds[name.slice(5)] = tensor;
    }
    results.push(outputs);
  }
  console.log(JSON.stringify(results));
}

main(process.argv[2], process.argv[3]).catch((error) => {
  console.error(error.message);
  process.exit(1);
});
