#include "lodestone/inference/checkpoint.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/random.h"
#include "temporary_folder.h"

namespace lodestone::inference {
namespace {

using Catch::Contains;
using tests::TemporaryFolder;

Checkpoint sample(double value) {
  Checkpoint checkpoint;
  checkpoint.kind = "sample";
  checkpoint.config["gain"] = value;
  checkpoint.facts["rng"] = "text";
  checkpoint.parts["net"] = {{"a.weight", Array(std::vector<float>(12, static_cast<float>(value)), {3, 4})},
                             {"b", Array(std::vector<double>(5, value), {5})}};
  checkpoint.parts["other"] = {{"count", Array(std::vector<std::int64_t>{7}, {})},
                               {"flags", Array(std::vector<std::uint8_t>(4, 1), {2, 2})},
                               {"none", Array(std::vector<float>(), {0, 3})}};
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
  for (const auto& [part, arrays] : saved.parts) {
    REQUIRE(loaded.parts.at(part).size() == arrays.size());
    for (const auto& [name, array] : arrays) CHECK(identical(loaded.parts.at(part).at(name), array));
  }
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
  SECTION("a run's folder, one or two levels too high") {
    const std::string inner = temporary / "run/policy/checkpoint";
    const std::string other = temporary / "run/other/checkpoint";
    save_checkpoint(inner, sample(1.0));
    Checkpoint of_another_kind = sample(1.0);
    of_another_kind.kind = "another";
    save_checkpoint(other, of_another_kind);
    CHECK_THAT(load_error(temporary / "run"), Contains("holds no manifest.json; name " + inner));
    rewrite(temporary / "run/policy/manifest.json", "{\"verb\": \"train-policy\"}");
    CHECK_THAT(load_error(temporary / "run/policy"), Contains("not that of a checkpoint") && Contains(inner));
    CHECK_THAT(load_error(temporary / "run"), !Contains(other));
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
  SECTION("a part that is no file") {
    for (const char* target : {"/dev/zero", "pipe"}) {
      std::filesystem::remove(part);
      std::filesystem::create_symlink(target, part);
      if (target[0] == 'p') REQUIRE(::mkfifo((folder + "/pipe").c_str(), 0600) == 0);
      CHECK_THAT(load_error(folder), Contains("net.safetensors cannot be read") && Contains("not a file"));
    }
  }
  SECTION("a part elsewhere") {
    auto json = common::Json::parse(good_manifest);
    json.erase("sha256");
    json["files"]["../net.safetensors"] = json["files"]["net.safetensors"];
    json["sha256"] = common::sha256(json.dump());
    rewrite(manifest, json.dump());
    CHECK_THAT(load_error(folder), Contains("no name of a file beside"));
  }
  SECTION("a manifest that is too deep, names a key twice or holds what no number is") {
    rewrite(manifest, "{\"format\": " + std::string(100'000, '['));
    CHECK_THAT(load_error(folder), Contains("manifest.json:1:") && Contains("deeper than 64"));
    rewrite(manifest, R"({"format": 1, "format": 1})");
    CHECK_THAT(load_error(folder), Contains("twice"));
    rewrite(manifest, R"({"format": 1e999})");
    CHECK_THAT(load_error(folder), Contains("too large"));
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

TEST_CASE("what a checkpoint lacks is named", "[unit]") {
  const Checkpoint checkpoint = sample(1.5);
  CHECK(checkpoint.at("other", "count", "test").to_double() == std::vector<double>{7.0});
  CHECK_THROWS_WITH(checkpoint.at("nothing", "b", "test"), Contains("test: part \"nothing\" is missing"));
  CHECK_THROWS_WITH(checkpoint.at("net", "c", "test"), Contains("array \"c\" of part \"net\""));
}

}  // namespace
}  // namespace lodestone::inference
