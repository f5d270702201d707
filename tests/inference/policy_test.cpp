#include "lodestone/inference/policy.h"

#include <catch2/catch.hpp>

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

TEST_CASE("the released policies load, and their examples recompute", "[unit]") {
  for (const char* name : {"target", "centre", "simulator_target", "simulator_centre"}) {
    INFO(name);
    const Policy policy = load_policy(std::string(LODESTONE_SOURCE_DIR) + "/models/" + name);
    CHECK(policy.actor().observation_size() == task::ObservationEncoder(policy.encoder).size());
  }
}

}  // namespace
}  // namespace lodestone::inference
