#include "lodestone/exports/policy_contract.h"

#include <catch2/catch.hpp>

#include "exports/policies.h"
#include "lodestone/common/error.h"

using namespace lodestone;
using exports::MemoryLayout;
using exports::PolicyContract;

TEST_CASE("a contract names what its policy sees", "[unit]") {
  task::EncoderConfig encoder;
  encoder.target = false;
  const PolicyContract least(tests::untrained_policy(encoder));
  REQUIRE(least.inputs().size() == 1);
  CHECK(least.inputs().front().elements == std::vector<std::string>{"x_m", "y_m", "heading_rad"});
  CHECK(least.outputs().size() == 1);
  CHECK_FALSE(least.remembers());

  encoder.relative_target = encoder.target_heading = encoder.drive_gain = encoder.memory = true;
  const PolicyContract most(tests::untrained_policy(encoder, 4));
  for (const char* name : {"pose", "target", "target_heading", "drive_gain", "memory"})
    CHECK(most.takes(name));
  CHECK(most.outputs().back().name == "next_memory");
  const std::vector<std::string>& memory = most.inputs().back().elements;
  CHECK(most.memory_size() == static_cast<std::int64_t>(memory.size()));
  CHECK(memory[MemoryLayout::kKnown] == "known");
  CHECK(memory[MemoryLayout::kPose] == "last_x_m");
  CHECK(memory[MemoryLayout::kAction] == "last_action_x");
  CHECK(memory[MemoryLayout::kPlace] == "place_x_m");
  CHECK(memory[MemoryLayout::kStalled] == "stalled_0_x");
  CHECK(most.memory_size() == MemoryLayout::kStalled + 2 * MemoryLayout::kStalls);
}

TEST_CASE("what is remembered without several proposals is the last pulse", "[unit]") {
  task::EncoderConfig encoder;
  encoder.memory = true;
  CHECK(PolicyContract(tests::untrained_policy(encoder)).memory_size() == MemoryLayout::kPlace);
}

TEST_CASE("per cent of drive become ampere where the rig says how", "[unit]") {
  inference::Policy policy = tests::untrained_policy({});
  CHECK(PolicyContract(policy).scale_A() == 15.0);
  policy.action.unit = "percent";
  policy.action.scale = 40.0;
  policy.rig = {{"full_drive_A", 5.0}};
  CHECK(PolicyContract(policy).scale_A() == Approx(2.0));
  for (const common::Json& rig :
       {common::Json(), common::Json({{"full_drive_A", 0.0}}), common::Json({{"full_drive_A", "much"}})}) {
    policy.rig = rig;
    CHECK_THROWS_WITH(
        PolicyContract(policy, "models/x"),
        Catch::Contains("models/x: its actions are per cent") && Catch::Contains("full_drive_A"));
    CHECK_THROWS_AS(PolicyContract(policy), common::ConfigError);
  }
}

TEST_CASE("a policy whose drives are fields is not exported as currents of four coils", "[unit]") {
  inference::Policy policy = tests::untrained_policy({});
  policy.rig = {{"drive", {{"kind", "opposed_pairs"}}}};
  CHECK_NOTHROW(PolicyContract(policy));
  policy.rig["drive"]["kind"] = "field";
  CHECK_THROWS_WITH(PolicyContract(policy, "models/x"),
                    Catch::Contains("models/x: its drives are not those of four coils in opposed pairs"));
  policy.rig = common::Json();  // whose nobody knows
  policy.action.size = policy.encoder.action_size = 6;
  CHECK_THROWS_WITH(PolicyContract(policy, "models/x"), Catch::Contains("in opposed pairs"));
}

TEST_CASE("every released policy has a contract with all its metadata", "[unit]") {
  const std::vector<std::string> folders = tests::released_policies();
  CHECK(folders.size() >= 5);
  for (const std::string& folder : folders) {
    CAPTURE(folder);
    const PolicyContract contract(inference::load_policy(folder));
    const auto metadata = contract.metadata();
    const common::Json described = common::Json::parse(metadata.at("contract"));
    for (const exports::ContractValue& value : contract.inputs())
      CHECK(described.at("inputs").at(value.name).at("elements").size() == value.elements.size());
    CHECK(common::Json::parse(metadata.at("rig")).contains("coils"));
    CHECK(common::Json::parse(metadata.at("task")).at("goal") == contract.policy().goal);
    CHECK(common::Json::parse(metadata.at("golden")).size() > 1);
  }
}
