#include "lodestone/rl/policy_environments.h"

#include <catch2/catch.hpp>
#include <vector>

#include "lodestone/common/error.h"

using namespace lodestone;

namespace {

rl::TrainPolicyConfig small_training() {
  rl::TrainPolicyConfig config;
  config.threads = 1;
  config.training.environments = 3;
  config.training.evaluation_episodes = 5;
  return config;
}

const std::string kModel = std::string(LODESTONE_SOURCE_DIR) + "/models/dynamics_best";

}  // namespace

TEST_CASE("The plain simulator needs no dynamics and is of the rig", "[rl]") {
  rl::TrainPolicyConfig config = small_training();
  config.simulator = rl::Simulator::kPhysics;
  config.rig.dish.radius_m = 0.03;
  const rl::PolicyEnvironments made = rl::make_policy_environments(config);
  CHECK(made.training->spec().count == 3);
  CHECK(made.evaluation->spec().count == 5);
  CHECK(made.region == nullptr);
  CHECK(config.task.dish_radius_m == 0.03);
  CHECK(made.fresh->spec().count == 5);
  const std::vector<float> evaluated = made.evaluation->reset();
  CHECK(made.training->reset() != evaluated);
  CHECK(made.fresh->reset() != evaluated);
}

TEST_CASE("The learned simulator must be named, and its data say what they know", "[rl]") {
  rl::TrainPolicyConfig config = small_training();
  CHECK_THROWS_WITH(rl::make_policy_environments(config), Catch::Contains("--set dynamics=DIR"));
  config.dynamics = kModel;
  config.rig.dish.radius_m = 0.03;
  const rl::PolicyEnvironments made = rl::make_policy_environments(config);
  CHECK(made.training->spec().count == 3);
  CHECK(config.task.dish_radius_m != 0.03);
}

TEST_CASE("The reachable region is mapped from the dynamics' data", "[rl]") {
  rl::TrainPolicyConfig config = small_training();
  config.simulator = rl::Simulator::kPhysics;
  config.task.within = task::Within::kReachable;
  CHECK_THROWS_WITH(rl::make_policy_environments(config), Catch::Contains("needs data to map"));
  config.dynamics = kModel;
  const rl::PolicyEnvironments made = rl::make_policy_environments(config);
  REQUIRE(made.region != nullptr);
  CHECK(made.region->area_m2() > 1e-4);
}

TEST_CASE("Recorded steps that are wanted must be there", "[rl]") {
  rl::TrainPolicyConfig config = small_training();
  config.simulator = rl::Simulator::kPhysics;
  config.replay.environments = 2;
  config.recorded = "/nowhere.h5";
  CHECK_THROWS_AS(rl::make_policy_environments(config), common::Error);
}
