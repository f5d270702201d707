#include "lodestone/nets/checkpoint.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/random.h"
#include "temporary_folder.h"

namespace lodestone::nets {
namespace {

using Catch::Contains;
using tests::TemporaryFolder;

Checkpoint sample(double value) {
  Checkpoint checkpoint;
  checkpoint.kind = "sample";
  checkpoint.config["gain"] = value;
  checkpoint.facts["rng"] = "text";
  checkpoint.parts["net"] = {{"a.weight", torch::full({3, 4}, value, torch::kFloat32)},
                             {"b", torch::full({5}, value, torch::kFloat64)}};
  checkpoint.parts["other"] = {{"count", torch::full({}, 7, torch::kInt64)},
                               {"flags", torch::ones({2, 2}, torch::kUInt8)},
                               {"none", torch::empty({0, 3})}};
  return checkpoint;
}

void rewrite(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
}

std::string load_error(const std::string& folder, const std::string& kind = "sample") {
  try {
    load_checkpoint(folder, kind);
  } catch (const common::CheckpointError& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("a checkpoint comes back as it was saved", "[unit]") {
  const TemporaryFolder temporary;
  const std::string folder = temporary / "checkpoint";
  save_checkpoint(folder, sample(1.5));
  save_checkpoint(folder + "/", sample(2.5));  // replaces the first
  const Checkpoint loaded = load_checkpoint(folder, "sample");
  const Checkpoint saved = sample(2.5);
  REQUIRE(loaded.config == saved.config);
  REQUIRE(loaded.facts == saved.facts);
  REQUIRE(loaded.parts.size() == saved.parts.size());
  for (const auto& [part, tensors] : saved.parts) {
    REQUIRE(loaded.parts.at(part).size() == tensors.size());
    for (const auto& [name, tensor] : tensors) {
      CHECK(loaded.parts.at(part).at(name).scalar_type() == tensor.scalar_type());
      CHECK(torch::equal(loaded.parts.at(part).at(name), tensor));
    }
  }
}

TEST_CASE("a safetensors file starts with the length of its header, which is JSON", "[unit]") {
  const std::string content = encode_safetensors({{"x", torch::tensor({1.0f, 2.0f})}});
  const auto length = static_cast<unsigned char>(content[0]);
  REQUIRE(content.size() == 8u + length + 8u);
  const auto header = common::Json::parse(content.substr(8, length));
  CHECK(header.at("x").at("dtype") == "F32");
  CHECK(header.at("x").at("data_offsets") == common::Json({0, 8}));
  const char one[] = {0, 0, '\x80', '\x3f'};
  CHECK(content.substr(8u + length, 4) == std::string(one, 4));
}

TEST_CASE("damaged or foreign checkpoints are refused with the reason", "[unit]") {
  const TemporaryFolder temporary;
  const std::string folder = temporary / "checkpoint";
  save_checkpoint(folder, sample(1.5));
  const std::string part = folder + "/net.safetensors";
  const std::string manifest = folder + "/manifest.json";
  const std::string good_part = common::read_file(part);
  const std::string good_manifest = common::read_file(manifest);

  SECTION("wrong kind") {
    CHECK_THAT(load_error(folder, "policy"), Contains("of kind \"sample\", expected \"policy\""));
  }
  SECTION("missing folder") { CHECK_THAT(load_error(temporary / "none"), Contains("no such folder")); }
  SECTION("missing part") {
    std::filesystem::remove(part);
    CHECK_THAT(load_error(folder), Contains("net.safetensors cannot be read"));
  }
  SECTION("truncated part") {
    rewrite(part, good_part.substr(0, good_part.size() / 2));
    CHECK_THAT(load_error(folder), Contains("net.safetensors is truncated"));
  }
  SECTION("truncated manifest") {
    rewrite(manifest, good_manifest.substr(0, good_manifest.size() / 2));
    CHECK_THAT(load_error(folder), Contains("manifest.json is truncated"));
  }
  SECTION("another format version") {
    auto json = common::Json::parse(good_manifest);
    json["format"] = kCheckpointFormat + 1;
    rewrite(manifest, json.dump());
    CHECK_THAT(load_error(folder), Contains("format version 2, this program reads 1"));
  }
  SECTION("altered manifest") {
    auto json = common::Json::parse(good_manifest);
    json["config"]["gain"] = 99.0;
    rewrite(manifest, json.dump());
    CHECK_THAT(load_error(folder), Contains("was altered"));
  }
  SECTION("one flipped bit, anywhere in a part") {
    for (std::size_t byte = 0; byte < good_part.size(); byte += 7) {
      std::string bad = good_part;
      bad[byte] = static_cast<char>(bad[byte] ^ (1 << (byte % 8)));
      rewrite(part, bad);
      CHECK_THAT(load_error(folder), Contains("net.safetensors was altered"));
    }
  }
}

TEST_CASE("malformed safetensors content never reads outside the file", "[unit]") {
  const std::string good = encode_safetensors({{"x", torch::arange(6, torch::kFloat32).view({2, 3})}});
  for (std::size_t length = 0; length < good.size(); ++length) {
    CHECK_THROWS_AS(decode_safetensors(good.substr(0, length), "file"), common::CheckpointError);
  }
  const auto with_header = [](std::string header) {
    std::string content(8, '\0');
    content[0] = static_cast<char>(header.size());
    return content + header + std::string(8, '\0');
  };
  for (const char* header :
       {R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,99]}})",
        R"({"x":{"dtype":"F32","shape":[-2],"data_offsets":[0,8]}})",
        R"({"x":{"dtype":"F32","shape":[4611686018427387904,4],"data_offsets":[0,0]}})",
        R"({"x":{"dtype":"F16","shape":[4],"data_offsets":[0,8]}})", R"({"x":[1]})", R"([1,2)", R"([1,2])"}) {
    CHECK_THROWS_AS(decode_safetensors(with_header(header), "file"), common::CheckpointError);
  }
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
