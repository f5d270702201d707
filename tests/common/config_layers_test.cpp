#include "lodestone/common/config_layers.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

struct Coil {
  std::int64_t turns = 560;
  double radius_m = 0.04;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("turns", turns, "", "turns", {1, 1000});
    v.field("radius_m", radius_m, "m", "radius", {0.0, 1.0});
    v.retired("windings", "turns");
  }
};

struct Run {
  std::int64_t seed = 1;
  Coil coil;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed", {0, 100});
    v.group("coil", coil, "the coil");
  }
};

std::string message(const common::ConfigLayers& layers) {
  try {
    common::config_from_json<Run>(layers.json(), layers.sources());
  } catch (const common::ConfigError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("later layers win key by key, and every value remembers where it came from") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "rig.json", R"({"turns": 500, "radius_m": 0.05})");
  common::write_file_atomically(folder / "run.json", R"({"seed": 7, "coil": {"turns": 510}})");
  common::ConfigLayers layers;
  layers.add_file(folder / "rig.json", "coil");
  layers.add_file(folder / "run.json");
  layers.set("seed=9", "--seed");
  const Run run = common::config_from_json<Run>(layers.json(), layers.sources());
  CHECK(run.seed == 9);
  CHECK(run.coil.turns == 510);
  CHECK(run.coil.radius_m == 0.05);
  CHECK(layers.sources().given("seed") == "--seed");
  CHECK(layers.sources().given("coil.turns") == folder / "run.json");
  CHECK(layers.sources().given("coil.radius_m") == folder / "rig.json");
  CHECK(layers.sources().given("coil.length_m").empty());
  const auto rows = common::describe_config<Run>(run, layers.sources());
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].source == "--seed");
  CHECK(rows[1].value == 510);
}

TEST_CASE("an error names the file or the option that held the value") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "a.json", R"({"coil": {"turns": 0}})");
  common::write_file_atomically(folder / "b.json", R"({"seed": 3})");
  common::ConfigLayers layers;
  layers.add_file(folder / "a.json");
  layers.add_file(folder / "b.json");
  CHECK_THAT(message(layers), Catch::Contains("a.json: coil.turns = 0 must be within 1 .. 1000"));
  layers.set("coil.turns=5", "--set coil.turns");
  CHECK(message(layers).empty());
  layers.set("seed=500", "--seed");
  CHECK_THAT(message(layers), Catch::Contains("--seed: seed = 500"));
  layers.set("seed=5", "--seed");
  layers.set("coil.tuns=5", "--set coil.tuns");
  CHECK_THAT(message(layers),
             Catch::Contains("--set coil.tuns: unknown key coil.tuns = 5; did you mean coil.turns?"));
}

TEST_CASE("a key of an earlier version is refused with what took its place") {
  common::ConfigLayers layers;
  layers.set("coil.windings=5", "--set coil.windings");
  CHECK_THAT(message(layers), Catch::Contains("coil.windings = 5 is no longer a key: use turns"));
}
