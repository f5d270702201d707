#include "lodestone/inference/onnx_model.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <opencv2/dnn.hpp>

#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "lodestone/common/shell.h"
#include "lodestone/inference/dense_network.h"
#include "temporary_folder.h"

using namespace lodestone;
using inference::OnnxModel;

namespace {

constexpr std::int64_t kSees = 5, kHidden = 7, kSays = 3;

std::vector<float> ramp(std::int64_t count, float step) {
  std::vector<float> numbers(static_cast<std::size_t>(count));
  float value = -1.0F;
  for (float& number : numbers) number = (value = value > 1.0F ? value - 2.0F : value + step);
  return numbers;
}

const inference::LinearLayer kFirst = {ramp(kHidden * kSees, 0.37F), ramp(kHidden, 0.11F)};
const inference::LinearLayer kSecond = {ramp(kSays * kHidden, 0.23F), ramp(kSays, 0.31F)};

/// y = W2 relu(W1 x + b1) + b2, of any number of rows.
OnnxModel two_layers() {
  OnnxModel model("two_layers");
  std::string x = model.input({"x", {"batch", kSees}, inference::ElementType::kFloat32, "what it sees (m)"});
  const std::string w1 = model.constant("w1", {kFirst.weight, {kHidden, kSees}});
  const std::string b1 = model.constant("b1", {kFirst.bias, {kHidden}});
  const std::string w2 = model.constant("w2", {kSecond.weight, {kSays, kHidden}});
  const std::string b2 = model.constant("b2", {kSecond.bias, {kSays}});
  x = model.node("Relu", {model.node("Gemm", {x, w1, b1}, {{"transB", std::int64_t{1}}, {"alpha", 1.0F}})});
  model.node("Gemm", {x, w2, b2}, {{"transB", std::int64_t{1}}}, "y");
  model.output({"y", {"batch", kSays}});
  model.metadata("rig", "a dish of 5 cm");
  return model;
}

}  // namespace

TEST_CASE("a network that is written as ONNX gives the same numbers in other programs' readers", "[unit]") {
  const tests::TemporaryFolder folder;
  const std::string bytes = two_layers().encode();
  common::write_file_atomically(folder / "two_layers.onnx", bytes);
  cv::dnn::Net opencv = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
  const inference::DenseNetwork ours({kFirst, kSecond});
  for (const std::int64_t rows : {1, 4}) {
    const std::vector<float> input = ramp(rows * kSees, 0.41F);
    inference::DenseNetwork::Workspace workspace;
    std::copy(input.begin(), input.end(), ours.input(rows, workspace));
    const float* expected = ours.forward(rows, workspace);

    opencv.setInput(cv::Mat(static_cast<int>(rows), kSees, CV_32F, const_cast<float*>(input.data())));
    const cv::Mat by_opencv = opencv.forward();
    const common::Json inputs = {{"x", {{"shape", {rows, kSees}}, {"numbers", input}}}};
    common::write_file_atomically(folder / "inputs.json", inputs.dump());
    const common::CommandResult run =
        common::run_command({"node", LODESTONE_SOURCE_DIR "/tests/node/onnx_outputs.js",
                             folder / "two_layers.onnx", folder / "inputs.json"});
    INFO(run.output);
    REQUIRE(run.exit_code == 0);
    const auto by_onnxruntime =
        common::Json::parse(run.output).at("y").at("numbers").get<std::vector<float>>();

    REQUIRE(by_opencv.total() == static_cast<std::size_t>(rows * kSays));
    REQUIRE(by_onnxruntime.size() == by_opencv.total());
    for (std::size_t i = 0; i < by_onnxruntime.size(); ++i) {
      CHECK(by_opencv.ptr<float>()[i] == Approx(expected[i]).margin(1e-6));
      CHECK(by_onnxruntime[i] == Approx(expected[i]).margin(1e-6));
    }
  }
}

TEST_CASE("lists, tensors and whole numbers reach an ONNX reader", "[unit]") {
  OnnxModel model("attributes");
  // Rearranges, then adds a constant that an attribute holds.
  const std::string x = model.input({"x", {std::int64_t{2}, std::int64_t{3}}});
  const std::string turned = model.node("Transpose", {x}, {{"perm", std::vector<std::int64_t>{1, 0}}});
  const std::string tens =
      model.node("Constant", {}, {{"value", inference::Array(std::vector<float>{10, 20}, {1, 2})}});
  const std::string sum = model.node("Add", {turned, tens});
  const std::string shape = model.constant("shape", {std::vector<std::int64_t>{-1}, {1}});
  model.node("Reshape", {sum, shape}, {}, "y");
  model.output({"y", {std::int64_t{6}}});
  const std::string bytes = model.encode();
  cv::dnn::Net net = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
  const cv::Mat_<float> numbers = (cv::Mat_<float>(2, 3) << 1, 2, 3, 4, 5, 6);
  net.setInput(numbers);
  const cv::Mat out = net.forward();
  REQUIRE(out.total() == 6);
  const std::vector<float> expected = {11, 24, 12, 25, 13, 26};
  CHECK(std::equal(expected.begin(), expected.end(), out.ptr<float>()));
}
