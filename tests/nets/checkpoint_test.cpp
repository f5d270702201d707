#include "lodestone/nets/checkpoint.h"

#include <catch2/catch.hpp>

#include <torch/torch.h>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

namespace lodestone::nets {
namespace {

using Catch::Contains;

TEST_CASE("tensors come back from a checkpoint as they were saved", "[unit]") {
  const tests::TemporaryFolder temporary;
  Checkpoint checkpoint;
  checkpoint.kind = "sample";
  checkpoint.facts["rng"] = "text";
  checkpoint.parts["net"] = {{"weight", torch::randn({3, 4})},
                             {"turned", torch::randn({3, 4}).t()},
                             {"wide", torch::randn({5}, torch::kFloat64)},
                             {"count", torch::full({}, 7, torch::kInt64)},
                             {"flags", torch::ones({2, 2}, torch::kUInt8)},
                             {"none", torch::empty({0, 3})}};
  save_checkpoint(temporary / "c", checkpoint);
  const Checkpoint loaded = load_checkpoint(temporary / "c", "sample");
  CHECK(loaded.facts == checkpoint.facts);
  REQUIRE(loaded.parts.at("net").size() == 6);
  for (const auto& [name, tensor] : checkpoint.parts.at("net")) {
    INFO(name);
    CHECK(loaded.parts.at("net").at(name).scalar_type() == tensor.scalar_type());
    CHECK(torch::equal(loaded.parts.at("net").at(name), tensor));
  }
}

TEST_CASE("a tensor that outlives its array keeps the numbers", "[unit]") {
  torch::Tensor tensor;
  {
    const inference::Array array(std::vector<float>{1, 2, 3}, {3});
    tensor = to_tensor(array);
  }
  CHECK(torch::equal(tensor, torch::tensor({1.0F, 2.0F, 3.0F})));
  CHECK(to_array(tensor).text() == "[3] float32");
  CHECK_THROWS_AS(to_array(torch::ones({2}, torch::kBool)), common::LogicFault);
}

TEST_CASE("modules take up only tensors that fit", "[unit]") {
  torch::nn::Linear linear(3, 2);
  NamedTensors tensors = module_tensors(*linear);
  for (auto& entry : tensors) entry.second = entry.second.clone() + 1.0;
  load_module_tensors(*linear, tensors, "test");
  CHECK(torch::equal(linear->weight, tensors.at("weight")));

  NamedTensors missing = tensors;
  missing.erase("bias");
  CHECK_THROWS_WITH(load_module_tensors(*linear, missing, "test"), Contains("\"bias\" is missing"));
  NamedTensors unexpected = tensors;
  unexpected["extra"] = torch::zeros({1});
  CHECK_THROWS_WITH(load_module_tensors(*linear, unexpected, "test"),
                    Contains("unexpected tensor \"extra\""));
  NamedTensors reshaped = tensors;
  reshaped["bias"] = torch::zeros({3});
  CHECK_THROWS_WITH(load_module_tensors(*linear, reshaped, "test"), Contains("expected [2]"));
}

}  // namespace
}  // namespace lodestone::nets
