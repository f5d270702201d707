#include "lodestone/safety/zones_file.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("zones are those that the file holds now") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "moving.json";
  const auto tell = [&path](const std::string& text) { common::write_file_atomically(path, text); };
  safety::ZonesFile file(path);
  tell(R"({"keep_out": [{"name": "hand", "corners_m": [0.01, 0.0], "radius_m": 0.004}]})");
  REQUIRE(file.zones().size() == 1);
  CHECK(file.zones().front().name == "hand");
  tell(
      R"({"keep_out": [{"corners_m": [0.0, 0.0, 0.0, 0.01]}, {"corners_m": [0.02, 0.0], "radius_m": 0.001}]})");
  REQUIRE(file.zones().size() == 2);
  CHECK(file.zones().front().corners_m.size() == 4);
  tell(R"({"keep_out": []})");
  CHECK(file.zones().empty());
  CHECK(safety::ZonesFile("").zones().empty());
}

TEST_CASE("a file that holds no zones is refused by its name, until it holds some again") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "moving.json";
  safety::ZonesFile file(path);
  CHECK_THROWS_WITH(file.zones(), Catch::Contains(path) && Catch::Contains("safety.keep_out_file"));
  for (const char* text : {"", "{", "[]", "{}", R"({"zones": []})", R"({"keep_out": {}})",
                           R"({"keep_out": [{"corners_m": [0.0]}]})", R"({"keep_out": [], "more": 1})",
                           R"({"keep_out": [{"corners_m": [0.0, 0.0], "radius_m": 0.0}]})"}) {
    INFO(text);
    common::write_file_atomically(path, text);
    CHECK_THROWS_AS(file.zones(), common::ConfigError);
    CHECK_THROWS_WITH(file.zones(), Catch::Contains(path));
  }
  common::write_file_atomically(path, R"({"keep_out": []})");
  CHECK(file.zones().empty());
}
