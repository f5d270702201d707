#include "lodestone/inference/dynamics.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/linear_model.h"
#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

using namespace lodestone;
using inference::DynamicsModel;

TEST_CASE("the released simulators load", "[unit]") {
  for (const char* name : {"dynamics_best", "dynamics_paper"}) {
    INFO(name);
    const DynamicsModel model =
        inference::load_dynamics(std::string(LODESTONE_SOURCE_DIR) + "/models/" + name);
    CHECK(static_cast<std::int64_t>(model.members.size()) == model.config.members);
    CHECK(model.start_states.size() % 3 == 0);
    CHECK(model.recorded_moves.size() > 1000);
    inference::FoldedDynamics::Workspace workspace;
    const double state[3] = {0.005, -0.003, 0.4};
    const double drive[2] = {6.0, -4.0};
    double next[3];
    model.members.front().predict(state, drive, 1, next, workspace);
    CHECK(std::hypot(next[0] - state[0], next[1] - state[1]) < 0.02);
  }
  CHECK_THROWS_AS(inference::load_dynamics("/nowhere"), common::CheckpointError);
}

TEST_CASE("a dataset's description comes back, and a malformed one is named", "[unit]") {
  data::DatasetInfo info;
  info.layout = data::StateLayout::kPosition;
  info.source = "test";
  info.workspace_radius_m = 0.03;
  info.action_scale = 89.0;
  common::Json facts;
  facts["dataset"] = data::info_to_json(info);
  const data::DatasetInfo back = inference::dataset_info_of(facts, "it");
  CHECK(back.layout == info.layout);
  CHECK(back.source == "test");
  CHECK(back.action_scale == 89.0);
  facts["dataset"]["workspace_radius_m"] = -1.0;
  CHECK_THROWS_AS(inference::dataset_info_of(facts, "it"), common::CheckpointError);
  facts["dataset"]["layout"] = "sideways";
  CHECK_THROWS_WITH(inference::dataset_info_of(facts, "it"), Catch::Contains("it: layout \"sideways\""));
}

TEST_CASE("an ensemble's mean averages turns, not headings", "[unit]") {
  const DynamicsModel model = env::tests::linear_model(data::StateLayout::kPose, {1e-3, 3e-3}, {0.3, -0.1});
  const double state[6] = {0.0, 0.01, 3.1, 0.02, 0.0, -1.0};
  const double drive[4] = {2.0, 0.0, 0.0, 1.0};
  double next[6];
  std::vector<double> one_member;
  inference::FoldedDynamics::Workspace workspace;
  inference::predict_mean(model.members, state, drive, 2, next, one_member, workspace);
  const double expected[6] = {0.004, 0.01, 3.2 - 2.0 * geometry::kPi, 0.02, 0.002, -0.9};
  for (std::size_t i = 0; i < 6; ++i) CHECK(next[i] == Approx(expected[i]).margin(1e-6));
}
