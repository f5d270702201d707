#include "lodestone/physics/coils_description.h"

#include <catch2/catch.hpp>

#include "lodestone/common/config.h"
#include "other_rigs.h"

namespace lodestone::physics {
namespace {

CoilsDescription read(const char* json) {
  return common::config_from_json<CoilsDescription>(common::Json::parse(json), "rig.json");
}

TEST_CASE("four coils around the dish are what is not listed") {
  const CoilsDescription coils;
  REQUIRE(coils.count() == 4);
  CHECK(coils.name(3) == "-y");
  CHECK(coils.name(4) == "4");
  CHECK(coils.coil(1).position_m == std::vector<double>{-0.08, 0.0, 0.0});
  CHECK(coils.coil(2).axis == std::vector<double>{0.0, 1.0, 0.0});
  CHECK(coils.largest_A(0) == 15.0);
  CHECK(coils.apart(0, 1));
  CHECK_FALSE(coils.apart(0, 2));
  CHECK_FALSE(coils.apart(1, 1));
}

TEST_CASE("listed coils take what they do not say from what all have") {
  const CoilsDescription coils = read(R"({"turns": 200, "max_current_A": 8, "resistance_20C_ohm": [1, 2],
    "inductance_H": [0.01, 0.02], "polarity": [1, -1], "each": [
      {"name": "a", "position_m": [0.1, 0, 0], "not_with": ["b"]},
      {"name": "b", "position_m": [0, 0.1, -0.02], "turns": 300, "max_current_A": 4, "bipolar": true}]})");
  REQUIRE(coils.count() == 2);
  CHECK(coils.coil(0).turns == 200);
  CHECK(coils.coil(1).turns == 300);
  CHECK(coils.largest_A(0) == 8.0);
  CHECK(coils.smallest_A(0) == 0.0);
  CHECK(coils.largest_A(1) == 4.0);
  CHECK(coils.smallest_A(1) == -4.0);
  CHECK(coils.apart(0, 1));
  CHECK(coils.apart(1, 0));
  // Written and read again it is the same.
  const common::Json json = common::config_to_json(coils);
  CHECK(common::config_to_json(common::config_from_json<CoilsDescription>(json, "again")) == json);
  CHECK(json["each"][1]["turns"] == 300);
}

TEST_CASE("what a person gets wrong in a list of coils is said, with its place") {
  const auto two = [](const std::string& second) {
    return R"({"resistance_20C_ohm": [1, 1], "inductance_H": [0.01, 0.01], "polarity": [1, 1], "each": [)"
           R"({"name": "a", "position_m": [0.1, 0, 0]}, )" +
           second + "]}";
  };
  const auto refused = [&](const std::string& second, const char* with) {
    CHECK_THROWS_WITH(read(two(second).c_str()), Catch::Contains(with));
  };
  refused(R"({"name": "a", "position_m": [0, 0.1, 0]})",
          "each[1].name = \"a\" must not be that of each[0], too: is it listed twice?");
  refused(R"({"name": "b", "position_m": [0.1, 0, 0]})", "is it listed twice?");
  refused(R"({"name": "b", "position_m": [0, 100, 0]})",
          "each[1].position_m = [0,100,0] must be within -1 .. 1");
  refused(R"({"name": "b", "position_m": [0, 0.1, 0], "not_with": ["c"]})",
          "hold names of other coils, which c is not");
  refused(R"({"name": "b", "position_m": [0, 0.1, 0], "turn": 5})", "unknown key each[1].turn");
  refused(R"({"name": "b", "position_m": [0, 0.1, 0], "inner_radius_m": 0.2})",
          "each[1].inner_radius_m = 0.2");
  refused(R"({"name": "b", "position_m": [0, 0.1, 0]}, {"name": "c", "position_m": [0, -0.1, 0]})",
          "must hold 3 numbers, one for each coil that coils.each lists");
  refused(R"({"name": "b", "position_m": [0, 0.1, 0], "max_current_A": 16})",
          "be at most max_current_A = 15");
  refused(R"({"name": "b", "position_m": [0, 0.1, 0], "harmonics_T_per_A": [1, 2]})",
          "each[1].harmonics_T_per_A = 2 must be 3, 8, 15");
  refused(R"({"name": "b", "position_m": [0, 0.1, 0], "harmonics_T_per_A": [1, 2, 3]})",
          "measured.centre_m = [] must be given");
  CHECK_THROWS_WITH(
      read(R"({"measured": {"centre_m": [0, 0, 0], "low_m": [-1, -1, -1], "high_m": [1, 1, 1]}})"),
      Catch::Contains("no coil has harmonics_T_per_A"));
  CHECK_THROWS_WITH(read(R"({"each": {"name": "a"}})"), Catch::Contains("a list of objects"));
  CHECK_THROWS_WITH(read(R"({"each": [3]})"), Catch::Contains("each[0] = 3 must be a JSON object"));
}

}  // namespace
}  // namespace lodestone::physics
