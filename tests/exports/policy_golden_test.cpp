#include "lodestone/exports/policy_golden.h"

#include <catch2/catch.hpp>

#include "exports/policies.h"
#include "lodestone/control/policy_controller.h"

using namespace lodestone;
using exports::GoldenEpisode;
using exports::GoldenStep;
using exports::PolicyContract;

TEST_CASE("golden decisions are always the same, of the policy's inputs, and of every kind", "[unit]") {
  const PolicyContract contract(inference::load_policy(LODESTONE_SOURCE_DIR "/models/any_rig"));
  const std::vector<GoldenEpisode> episodes = golden_episodes(contract);
  CHECK(golden_json(episodes) == golden_json(golden_episodes(contract)));
  int stays = 0, moves = 0, driven = 0;
  for (const GoldenEpisode& episode : episodes) {
    REQUIRE(episode.size() == episodes.front().size());
    const std::vector<float>* last = nullptr;
    for (const GoldenStep& step : episode) {
      for (const exports::ContractValue& value : contract.inputs())
        CHECK(step.inputs.count(value.name) == (value.name == "memory" ? 0 : 1));
      const std::vector<float>& pose = step.inputs.at("pose");
      if (last != nullptr)
        (std::hypot(pose[0] - (*last)[0], pose[1] - (*last)[1]) < 3e-4F ? stays : moves) += 1;
      last = &pose;
      CHECK((step.current_A[0] == 0.0F || step.current_A[1] == 0.0F));
      driven += step.current_A[0] + step.current_A[1] > 0.0F ? 1 : 0;
      for (const float current_A : step.current_A) CHECK(current_A <= 15.0F);
    }
  }
  CHECK(stays > 10);
  CHECK(moves > 10);
  CHECK(driven > 10);
}

TEST_CASE("some golden decisions are not the best proposal, as that had moved nothing", "[unit]") {
  const PolicyContract contract(inference::load_policy(LODESTONE_SOURCE_DIR "/models/any_rig"));
  control::PolicyController forgetful(contract.policy());
  int others = 0;
  for (const GoldenEpisode& episode : golden_episodes(contract)) {
    task::Observation seen;
    for (const GoldenStep& step : episode) {
      const std::vector<float>& pose = step.inputs.at("pose");
      const geometry::Vector2 before_m = seen.pose.position_m();
      seen.pose = {pose[0], pose[1], pose[2]};
      seen.last_displacement_m.setZero();
      if (&step != &episode.front()) seen.last_displacement_m = seen.pose.position_m() - before_m;
      seen.target_m = {step.inputs.at("target")[0], step.inputs.at("target")[1]};
      seen.drive_gain = task::DriveGain{step.inputs.at("drive_gain")[0], step.inputs.at("drive_gain")[1]};
      forgetful.reset();
      const geometry::Vector2 given((step.current_A[0] - step.current_A[1]) / 15.0F,
                                    (step.current_A[2] - step.current_A[3]) / 15.0F);
      others += (forgetful.act(seen) - given).norm() > 1e-3 ? 1 : 0;
      seen.last_action = given;
    }
  }
  CHECK(others >= 3);
}

TEST_CASE("golden decisions are written as their inputs and currents", "[unit]") {
  const std::vector<GoldenEpisode> episodes = {{{{{"pose", {1.0F, 2.0F, 3.0F}}}, {4.0F, 0.0F, 0.5F, 0.0F}}}};
  CHECK(golden_json(episodes).dump() == R"([[{"pose":[1.0,2.0,3.0],"current":[4.0,0.0,0.5,0.0]}]])");
}
