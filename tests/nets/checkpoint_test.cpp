#include "lodestone/nets/checkpoint.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "temporary_folder.h"

namespace lodestone::nets {
namespace {

TEST_CASE("tensors come back from a checkpoint as they were saved", "[unit]") {
  const tests::TemporaryFolder temporary;
  Checkpoint checkpoint;
  checkpoint.kind = "sample";
  checkpoint.facts["rng"] = "text";
  checkpoint.parts["net"] = {{"weight", at::randn({3, 4})},          {"turned", at::randn({3, 4}).t()},
                             {"wide", at::randn({5}, at::kDouble)},  {"count", at::full({}, 7, at::kLong)},
                             {"flags", at::ones({2, 2}, at::kByte)}, {"none", at::empty({0, 3})}};
  save_checkpoint(temporary / "c", checkpoint);
  const Checkpoint loaded = load_checkpoint(temporary / "c", "sample");
  CHECK(loaded.facts == checkpoint.facts);
  REQUIRE(loaded.parts.at("net").size() == 6);
  for (const auto& [name, tensor] : checkpoint.parts.at("net")) {
    INFO(name);
    CHECK(loaded.parts.at("net").at(name).scalar_type() == tensor.scalar_type());
    CHECK(at::equal(loaded.parts.at("net").at(name), tensor));
  }
}

}  // namespace
}  // namespace lodestone::nets
