#include "lodestone/physics/rig_description.h"

#include <catch2/catch.hpp>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "measured_rig.h"
#include "sphere_rig.h"

namespace lodestone::physics {
namespace {

RigDescription read(const char* json) {
  return common::config_from_json<RigDescription>(common::Json::parse(json), "rig.json");
}

TEST_CASE("a rig that cannot be is refused, with the key that says so") {
  CHECK_NOTHROW(read("{}"));
  CHECK_NOTHROW(read(R"({"dish": {"radius_m": 0.04}})"));
  CHECK_THROWS_WITH(read(R"({"dish": {"radius_m": 0.01}})"),
                    Catch::StartsWith("rig.json: needle.length_m = 0.0235 must"));
  CHECK_THROWS_WITH(read(R"({"dish": {"radius_m": 0.051}})"), Catch::Contains("dish.radius_m = 0.051"));
  CHECK_THROWS_AS(read(R"({"needle": {"chain_m": 0.05}})"), common::ConfigError);
  CHECK_THROWS_WITH(read(R"({"fluid": {"depth_m": 0.02}})"), Catch::Contains("dish.wall_height_m = 0.01"));
  CHECK_THROWS_AS(read(R"({"friction": {"kinetic_coefficient": 0.9}})"), common::ConfigError);
  CHECK_THROWS_AS(read(R"({"coils": {"inner_radius_m": 0.2}})"), common::ConfigError);
  CHECK_THROWS_WITH(read(R"({"coils": {"polarity": [1, 0, 1, 1]}})"),
                    Catch::Contains("coils.polarity = [1,0,1,1] must hold 1 or -1"));
  CHECK_THROWS_WITH(read(R"({"coils": {"resistance_20C_ohm": [1, 1, 1]}})"),
                    Catch::Contains("must hold four numbers"));
  CHECK_THROWS_WITH(read(R"({"coil": {"turns": 500}})"), Catch::Contains("use coils"));
}

TEST_CASE("a drive that does not fit the coils, and a winding in the dish, are refused") {
  common::Json six = common::config_to_json(tests::ring_rig(6));
  CHECK_NOTHROW(common::config_from_json<RigDescription>(six, "rig.json"));
  six["coils"]["each"][2]["position_m"] = {0.03, 0.04, 0.0};
  CHECK_THROWS_WITH(
      common::config_from_json<RigDescription>(six, "rig.json"),
      Catch::Contains("coils.each[2].position_m = [0.03,0.04,0.0] must keep the winding of coil c3 "
                      "out of the dish of 0.0425 m"));
  six["coils"]["each"][2]["position_m"] = {0.0, 0.0, -0.0305};  // half a millimetre under the plane
  six["coils"]["each"][2]["axis"] = {0.0, 0.0, 1.0};
  CHECK_THROWS_WITH(common::config_from_json<RigDescription>(six, "rig.json"),
                    Catch::Contains("0.001 m away"));
  six = common::config_to_json(tests::ring_rig(6));
  six["drive"]["kind"] = "opposed_pairs";
  CHECK_THROWS_WITH(common::config_from_json<RigDescription>(six, "rig.json"),
                    Catch::Contains("must be field or independent: opposed_pairs drives +x, -x, +y and -y, "
                                    "and coils.each lists 6 others"));
}

TEST_CASE("a dish that reaches beyond what was measured of the coils is refused") {
  common::Json small = common::config_to_json(tests::measured_small_ring_rig());
  CHECK_NOTHROW(common::config_from_json<RigDescription>(small, "rig.json"));
  small["dish"]["radius_m"] = 0.026;
  CHECK_THROWS_WITH(common::config_from_json<RigDescription>(small, "rig.json"),
                    Catch::Contains("rig.json: dish.radius_m = 0.026 must be at most 0.02") &&
                        Catch::Contains("coils.measured"));
}

TEST_CASE("how far out a needle comes, and a sphere") {
  const RigDescription rig;
  CHECK(rig.reach_m() == Approx(0.04084).margin(1e-5));  // along the wall
  CHECK(rig.fits({0.0, rig.reach_m() - 1e-6, 0.0}));
  CHECK_FALSE(rig.fits({0.0, rig.reach_m() - 1e-6, 1.57}));
  const RigDescription round = tests::sphere_rig();
  CHECK(round.reach_m() == Approx(0.041));
  CHECK(round.fits({0.0, 0.0409, 1.57}));
  CHECK_FALSE(round.fits({0.0411, 0.0, 1.57}));
  CHECK(round.fits({0.0411, 0.0, 1.57}, 1e-3));
  CHECK_THROWS_WITH(read(R"({"needle": {"shape": "sphere"}})"),
                    Catch::Contains("needle.length_m = 0.0235 must be diameter_m"));
}

TEST_CASE("what an earlier version recorded of a rig is completed by what is usual") {
  common::Json recorded = common::config_to_json(RigDescription{});
  recorded["coils"].erase("each");
  recorded.erase("drive");
  recorded.erase("amplifier");
  recorded["dish"]["radius_m"] = 0.04;
  const common::Json whole = completed_rig(recorded);
  CHECK(whole["drive"]["kind"] == "opposed_pairs");
  CHECK(whole["amplifier"]["controls"] == "duty");
  CHECK(whole["coils"] == common::config_to_json(RigDescription{})["coils"]);
  CHECK(whole["dish"]["radius_m"] == 0.04);
}

TEST_CASE("drives are of another kind where their numbers mean something else") {
  const auto of = [](const char* drive) { return completed_rig({{"drive", common::Json::parse(drive)}}); };
  CHECK(other_drive(of("{}"), completed_rig({{"dish", {{"radius_m", 0.03}}}})).empty());
  CHECK(other_drive(of(R"({"kind": "independent"})"), of("{}")) ==
        "rig.drive.kind = \"independent\", not \"opposed_pairs\"");
  CHECK(other_drive(of(R"({"kind": "field", "field_numbers": 3})"), of(R"({"kind": "field"})")) ==
        "rig.drive.field_numbers = 3, not 2");
  CHECK(other_drive(of(R"({"kind": "field", "field_share": 0.5})"), of(R"({"kind": "field"})")).empty());
}

TEST_CASE("drivers that cannot be are refused, with the key that says so") {
  CHECK(RigDescription{}.amplifier.ideal());
  CHECK_FALSE(read(R"({"amplifier": {"ramp_s": 0.05}})").amplifier.ideal());
  CHECK_NOTHROW(read(R"({"amplifier": {"controls": "current", "time_constant_s": 0.002}})"));
  CHECK_THROWS_WITH(read(R"({"amplifier": {"ramp_s": -0.05}})"), Catch::Contains("amplifier.ramp_s = -0.05"));
  CHECK_THROWS_WITH(read(R"({"amplifier": {"duty_steps": 0.5}})"), Catch::Contains("amplifier.duty_steps"));
  CHECK_THROWS_WITH(read(R"({"amplifier": {"controls": "volt"}})"), Catch::Contains("amplifier.controls"));
  CHECK_THROWS_WITH(read(R"({"amplifier": {"controls": "current", "ramp_s": 0.05}})"),
                    Catch::Contains("amplifier.ramp_s = 0.05 must be 0 where amplifier.controls is current"));
  CHECK_THROWS_WITH(read(R"({"amplifier": {"controls": "current", "duty_steps": 100}})"),
                    Catch::Contains("amplifier.duty_steps = 100 must be 0"));
  CHECK_THROWS_WITH(
      read(R"({"amplifier": {"time_constant_s": 0.002}})"),
      Catch::Contains("amplifier.time_constant_s = 0.002 must be 0 where amplifier.controls is duty"));
  CHECK_NOTHROW(read(R"({"supply_resistance_ohm": 2.2})"));
  CHECK_THROWS_WITH(read(R"({"supply_resistance_ohm": 2.3})"),
                    Catch::Contains("supply_resistance_ohm = 2.3 must be below"));
}

TEST_CASE("listed coils of an earlier version are completed, too") {
  common::Json recorded = common::config_to_json(tests::ring_rig(6));
  for (common::Json& coil : recorded["coils"]["each"]) coil.erase("harmonics_T_per_A");
  CHECK(completed_rig(recorded) == common::config_to_json(tests::ring_rig(6)));
}

TEST_CASE("every coil has its own circuit") {
  const RigDescription rig =
      read(R"({"coils": {"resistance_20C_ohm": [1.8, 1.9, 2.0, 2.1]}, "supply_V": 30, "ambient_C": 25})");
  CHECK(rig.circuit(3).resistance_20C_ohm == 2.1);
  CHECK(rig.circuit(0).supply_V == 30.0);
  CHECK(rig.circuit(0).ambient_C == 25.0);
}

TEST_CASE("the needle fits where both its ends lie inside the wall") {
  const RigDescription rig;
  CHECK(rig.fits({0.03, 0.0, 0.0}));
  CHECK_FALSE(rig.fits({0.032, 0.0, 0.0}));
  CHECK(rig.fits({0.032, 0.0, 1.5707963}));
}

}  // namespace
}  // namespace lodestone::physics
