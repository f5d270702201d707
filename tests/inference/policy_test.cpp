#include "lodestone/inference/policy.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "inference/random_policy.h"
#include "lodestone/common/error.h"
#include "lodestone/inference/checkpoint.h"
#include "temporary_folder.h"

namespace lodestone::inference {
namespace {

Policy sample_policy() {
  Policy policy;
  policy.hidden = {32, 16};
  policy.encoder.heading = task::HeadingEncoding::kSineCosine;
  policy.action.dead_band = 0.05;
  policy.goal = "centre";
  tests::draw_weights(policy, 4);
  return policy;
}

std::vector<float> action_of(const Policy& policy, const std::vector<float>& observation) {
  std::vector<float> action(2);
  Actor::Workspace workspace;
  policy.actor().act(observation.data(), 1, action.data(), workspace);
  return action;
}

TEST_CASE("a policy comes back with its encoder and acts the same", "[unit]") {
  const tests::TemporaryFolder temporary;
  const Policy policy = sample_policy();
  save_policy(temporary / "policy", policy, common::Json::object(), common::Json::object());
  const Policy loaded = load_policy(temporary / "policy");
  CHECK(loaded.encoder.heading == task::HeadingEncoding::kSineCosine);
  CHECK(loaded.action.dead_band == 0.05);
  CHECK(loaded.goal == "centre");
  const std::vector<float> observation = {0.1F, 0.2F, 0.3F, -0.4F, 0.5F, -0.6F};
  CHECK(action_of(policy, observation) == action_of(loaded, observation));
}

TEST_CASE("a policy of proposals comes back with them", "[unit]") {
  const tests::TemporaryFolder temporary;
  Policy policy = sample_policy();
  policy.proposals = 2;
  policy.encoder.drive_gain = true;
  tests::draw_weights(policy, 5);
  save_policy(temporary / "policy", policy, common::Json::object(), common::Json::object());
  const Policy loaded = load_policy(temporary / "policy");
  CHECK(loaded.proposals == 2);
  CHECK(loaded.encoder.drive_gain);
  const std::vector<float> observation = {0.1F, 0.2F, 0.3F, -0.4F, 0.5F, -0.6F, 0.2F, 0.1F};
  CHECK(action_of(policy, observation) == action_of(loaded, observation));
}

TEST_CASE("a policy comes back with the cost-to-go that was learned beside it", "[unit]") {
  const tests::TemporaryFolder temporary;
  Policy policy = sample_policy();
  PoseCost cost;
  cost.tolerance_deg = 7.0;
  cost.dish_radius_m = 0.04;
  const auto numbers = [](std::int64_t count, float value) {
    return std::vector<float>(static_cast<std::size_t>(count), value);
  };
  const Arrays weights = {{"l1.weight", {numbers(4 * CostToGo::kFeatures, 0.1F), {4, CostToGo::kFeatures}}},
                          {"l1.bias", {numbers(4, 0.0F), {4}}},
                          {"l2.weight", {numbers(4, 0.2F), {1, 4}}},
                          {"l2.bias", {numbers(1, 0.1F), {1}}}};
  policy.cost_to_go.emplace(weights, std::vector<std::int64_t>{4}, cost);
  save_policy(temporary / "policy", policy, common::Json::object(), common::Json::object());
  const Policy loaded = load_policy(temporary / "policy");
  REQUIRE(loaded.cost_to_go);
  CHECK(loaded.cost_to_go->cost().tolerance_deg == 7.0);
  const auto cost_by = [](const CostToGo& learned) {
    const double state[] = {0.01, 0.002, 0.5};
    const geometry::Pose2 goal{0.0, 0.0, 0.0};
    CostToGo::Workspace workspace;
    double out = 0.0;
    learned.evaluate(state, &goal, 1, 1, &out, workspace);
    return out;
  };
  CHECK(cost_by(*loaded.cost_to_go) == cost_by(*policy.cost_to_go));

  Checkpoint checkpoint = load_checkpoint(temporary / "policy", "policy");
  checkpoint.facts["cost_to_go"]["cost"]["discount"] = 1.5;
  save_checkpoint(temporary / "policy", checkpoint);
  CHECK_THROWS_WITH(load_policy(temporary / "policy"),
                    Catch::Contains("cost_to_go") && Catch::Contains("discount"));
}

TEST_CASE("a policy whose examples do not recompute is refused", "[unit]") {
  const tests::TemporaryFolder temporary;
  save_policy(temporary / "policy", sample_policy(), common::Json::object(), common::Json::object());
  Checkpoint checkpoint = load_checkpoint(temporary / "policy", "policy");
  std::vector<float> action = checkpoint.at("examples", "action", "test").to_vector<float>();
  action[3] += 1e-3F;
  checkpoint.parts["examples"]["action"] = {action, {16, 2}};
  save_checkpoint(temporary / "policy", checkpoint);
  CHECK_THROWS_WITH(load_policy(temporary / "policy"), Catch::Contains("recomputed example actions differ"));
  CHECK_THROWS_AS(load_policy(temporary / "none"), common::CheckpointError);
}

TEST_CASE("what was noted about a policy's making comes back with it", "[unit]") {
  const tests::TemporaryFolder temporary;
  save_policy(temporary / "policy", sample_policy(), common::Json::object(), common::Json::object());
  set_policy_provenance(temporary / "policy", {{"dynamics", {{"rms_mm", 0.5}}}});
  CHECK(load_policy(temporary / "policy").provenance["dynamics"]["rms_mm"] == 0.5);
}

TEST_CASE("a policy keeps the region it was trained in", "[unit]") {
  const tests::TemporaryFolder temporary;
  Policy policy = sample_policy();
  std::vector<task::Move> moves;
  for (int i = 0; i < 40; ++i) moves.push_back({{0.001, 0.001}, {-0.003, 0.001}});
  for (int i = 0; i < 40; ++i) moves.push_back({{-0.003, 0.001}, {0.001, 0.001}});
  policy.region = task::Region(moves, {});
  save_policy(temporary / "policy", policy, common::Json::object(), common::Json::object());
  const Policy loaded = load_policy(temporary / "policy");
  REQUIRE(loaded.region);
  CHECK(loaded.region->contains({0.001, 0.001}));
  CHECK_FALSE(loaded.region->contains({0.02, 0.001}));
}

TEST_CASE("a sealed policy whose numbers cannot be is refused by name", "[unit]") {
  const tests::TemporaryFolder temporary;
  const std::string folder = temporary / "policy";
  const auto fault_of = [&](const auto& spoil) {
    save_policy(folder, sample_policy(), common::Json::object(), common::Json::object());
    Checkpoint checkpoint = load_checkpoint(folder, "policy");
    spoil(checkpoint);
    save_checkpoint(folder, checkpoint);
    try {
      load_policy(folder);
    } catch (const common::CheckpointError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  for (const char* hidden :
       {"[-1]", "[0]", "[1e12]", "[2.5]", "3", "[8193]", "[1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1]"}) {
    CHECK_THAT(fault_of([&](Checkpoint& c) { c.facts["hidden"] = common::Json::parse(hidden); }),
               Catch::Contains("hidden = " + common::Json::parse(hidden).dump()));
  }
  CHECK_THAT(fault_of([](Checkpoint& c) {
               c.facts["hidden"] = {0};
               c.parts["actor"] = {{"l1.weight", Array(std::vector<float>{}, {0, 6})},
                                   {"l1.bias", Array(std::vector<float>{}, {0})},
                                   {"l2.weight", Array(std::vector<float>{}, {2, 0})},
                                   {"l2.bias", Array(std::vector<float>{0, 0}, {2})}};
             }),
             Catch::Contains("hidden = [0]"));
  CHECK_THAT(
      fault_of([](Checkpoint& c) { c.parts["actor"]["l2.bias"] = Array(std::vector<float>(16, NAN), {16}); }),
      Catch::Contains("array \"l2.bias\" holds nan at place 0"));
  CHECK_THAT(
      fault_of([](Checkpoint& c) { c.parts["actor"]["l2.bias"] = Array(std::vector<double>(16), {16}); }),
      Catch::Contains("l2.bias"));
  for (const char* name : {"observation", "action"}) {
    CHECK_THAT(fault_of([&](Checkpoint& c) {
                 c.parts["examples"][name] = Array(std::vector<double>(32), {16, 2});
               }),
               Catch::Contains(name));
    CHECK_THAT(fault_of([&](Checkpoint& c) {
                 c.parts["examples"][name] = Array(std::vector<float>{}, {0, 2});
               }),
               Catch::Contains("xample"));
  }
  CHECK_THAT(fault_of([](Checkpoint& c) { c.facts["encoder"]["length_scale_m"] = 0.0; }),
             Catch::Contains("length_scale_m"));
  CHECK_THAT(fault_of([](Checkpoint& c) { c.facts["action"]["scale"] = 1e300; }), Catch::Contains("scale"));
  CHECK_THAT(fault_of([](Checkpoint& c) {
               c.facts["region"] = {{"cell_m", 1e-300}, {"cells", {{0, 0}}}};
             }),
             Catch::Contains("cell_m"));
}

TEST_CASE("the released policies load, and their examples recompute", "[unit]") {
  for (const char* name : {"target", "centre", "simulator_target", "simulator_centre"}) {
    INFO(name);
    const Policy policy = load_policy(std::string(LODESTONE_SOURCE_DIR) + "/models/" + name);
    CHECK(policy.actor().observation_size() == task::ObservationEncoder(policy.encoder).size());
  }
}

}  // namespace
}  // namespace lodestone::inference
