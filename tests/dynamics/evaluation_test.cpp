#include "lodestone/dynamics/evaluation.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "dynamics/synthetic_motion.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::dynamics {
namespace {

/// A model that always predicts the same change of state, whatever the drive.
Model constant_model(data::StateLayout layout, const std::vector<double>& change,
                     const data::Dataset& training) {
  const at::NoGradGuard no_grad;
  Model model;
  model.config.form = inference::DynamicsForm::kDelta;
  model.config.hidden = {4};
  model.config.batch_norm = false;
  model.info.layout = layout;
  model.members = make_members(model.config, layout, 1);
  for (auto& parameter : model.members[0]->tensors().parameters()) parameter.zero_();
  const data::TransitionTable table = data::flatten(training);
  const auto rows = table.size();
  const auto narrow = [rows](const std::vector<double>& numbers, std::int64_t columns) {
    return nets::to_array(nets::tensor_from(numbers, {rows, columns}, at::kFloat));
  };
  model.training_rows = {narrow(table.state, table.state_size), narrow(table.action, 2),
                         narrow(table.next_state, table.state_size)};
  const auto size = static_cast<std::int64_t>(change.size());
  model.members[0]->output_mean.copy_(nets::tensor_from(change, {size}));
  return model;
}

/// Episodes that move by (3, 4) mm each step and turn by half a radian.
data::Dataset marching(data::StateLayout layout, std::int64_t episodes, std::int64_t steps) {
  data::Dataset dataset;
  dataset.info.layout = layout;
  dataset.info.workspace_radius_m = 0.0425;
  for (std::int64_t e = 0; e < episodes; ++e) {
    data::Episode episode;
    for (std::int64_t t = 0; t <= steps; ++t) {
      const auto n = static_cast<double>(t);
      episode.observations.insert(episode.observations.end(), {3e-3 * n, 4e-3 * n});
      if (layout == data::StateLayout::kPose)
        episode.observations.push_back(geometry::wrap_angle(3.0 + 0.5 * n));
      if (t == steps) break;
      episode.actions.insert(episode.actions.end(), {1.0, static_cast<double>(e + 1)});
      episode.terminations.push_back(0);
      episode.truncations.push_back(0);
      episode.zero_current.push_back(0);
    }
    dataset.episodes.push_back(episode);
  }
  return dataset;
}

TEST_CASE("errors of a model that never moves are those of the motion", "[unit]") {
  const data::Dataset dataset = marching(data::StateLayout::kPose, 3, 6);
  Model model = constant_model(data::StateLayout::kPose, {0.0, 0.0, 0.0}, dataset);
  const DynamicsEvaluation evaluation = evaluate_dynamics(model, dataset);
  CHECK(evaluation.n == 18);
  CHECK(evaluation.one_step.position_rms_mm == Approx(5.0));
  CHECK(evaluation.one_step.heading_rms_deg.value() == Approx(0.5 * 180.0 / geometry::kPi));
  CHECK(evaluation.baselines->no_motion.position_rms_mm == Approx(5.0));
  CHECK(evaluation.baselines->no_motion.heading_rms_deg.value() == Approx(0.5 * 180.0 / geometry::kPi));
  CHECK(evaluation.open_loop.k_step_mm->at(1).value() == Approx(5.0));
  CHECK(evaluation.open_loop.k_step_mm->at(2).value() == Approx(10.0));
  CHECK(evaluation.open_loop.k_step_mm->at(5).value() == Approx(25.0));
  CHECK_FALSE(evaluation.open_loop.k_step_mm->at(10).has_value());  // no episode is that long
  // Normalisers are the identity here but for their mean, so the loss is the mean square over three columns.
  CHECK(evaluation.normalised_l2 == Approx((9e-6 + 16e-6 + 0.25) / 3.0).epsilon(1e-3));
  CHECK(evaluation.baselines->nearest_neighbours.position_rms_mm == Approx(0.0).margin(1e-3));
}

TEST_CASE("a model that knows the motion has no error at any number of steps", "[unit]") {
  const data::Dataset dataset = marching(data::StateLayout::kPose, 2, 12);
  Model model = constant_model(data::StateLayout::kPose, {3e-3, 4e-3, 0.5}, dataset);
  const DynamicsEvaluation evaluation = evaluate_dynamics(model, dataset);
  CHECK(evaluation.one_step.position_rms_mm == Approx(0.0).margin(1e-3));
  CHECK(evaluation.one_step.heading_rms_deg.value() == Approx(0.0).margin(1e-3));
  CHECK(evaluation.open_loop.k_step_mm->at(10).value() == Approx(0.0).margin(1e-3));
  CHECK(evaluation.normalised_state_l2 == Approx(0.0).margin(1e-6));
}

TEST_CASE("headings are followed open loop, of the model as of both baselines", "[unit]") {
  const data::Dataset dataset = marching(data::StateLayout::kPose, 2, 12);
  Model model = constant_model(data::StateLayout::kPose, {3e-3, 4e-3, 0.4}, dataset);  // 0.1 rad too little
  const DynamicsEvaluation evaluation = evaluate_dynamics(model, dataset);
  const runs::DynamicsBaselines& baselines = evaluation.baselines.value();
  for (const int steps : {1, 2, 5, 10}) {
    CAPTURE(steps);
    CHECK(evaluation.open_loop.k_step_heading_deg->at(steps).value() ==
          Approx(0.1 * steps * geometry::kDegPerRad));
    CHECK(baselines.no_motion_open_loop->k_step_mm->at(steps).value() == Approx(5.0 * steps));
    CHECK(baselines.no_motion_open_loop->k_step_heading_deg->at(steps).value() ==
          Approx(std::abs(geometry::wrap_angle(0.5 * steps)) * geometry::kDegPerRad));
    // Every training row moves alike, in float32.
    CHECK(baselines.nearest_neighbours_open_loop->k_step_mm->at(steps).value() == Approx(0.0).margin(1e-3));
    CHECK(baselines.nearest_neighbours_open_loop->k_step_heading_deg->at(steps).value() ==
          Approx(0.0).margin(1e-3));
  }
  CHECK_FALSE(evaluation.region_coverage.has_value());
}

TEST_CASE("open-loop chains leave pulses without current at rest", "[unit]") {
  data::Dataset dataset = marching(data::StateLayout::kPosition, 1, 2);
  data::Episode& episode = dataset.episodes[0];
  episode.observations = {0.0, 0.0, 0.0, 0.0, 3e-3, 4e-3};
  episode.actions = {0.0, 0.0, 1.0, 1.0};
  episode.zero_current = {1, 0};
  Model model = constant_model(data::StateLayout::kPosition, {3e-3, 4e-3}, dataset);
  const DynamicsEvaluation evaluation = evaluate_dynamics(model, dataset);
  CHECK(evaluation.n == 1);
  CHECK_FALSE(evaluation.one_step.heading_rms_deg.has_value());
  CHECK(evaluation.open_loop.k_step_mm->at(2).value() == Approx(0.0).margin(1e-4));
}

TEST_CASE("the error map holds every row once", "[unit]") {
  const data::Dataset dataset = tests::known_dataset(data::StateLayout::kPosition, 30, 20, 5);
  Model model = constant_model(data::StateLayout::kPosition, {0.0, 0.0}, dataset);
  const DynamicsEvaluation evaluation = evaluate_dynamics(model, dataset);
  std::int64_t rows = 0;
  double squares = 0.0;
  for (const ErrorCell& cell : evaluation.error_map) {
    rows += cell.n;
    squares += cell.rms_mm * cell.rms_mm * static_cast<double>(cell.n);
    CHECK(std::abs(std::remainder(cell.x_m - 2.5e-3, 5e-3)) < 1e-12);
  }
  CHECK(rows == evaluation.n);
  CHECK(std::sqrt(squares / static_cast<double>(rows)) == Approx(evaluation.one_step.position_rms_mm));
}

TEST_CASE("predictions are held beside what happened, some of many rows", "[unit]") {
  const data::Dataset dataset = marching(data::StateLayout::kPose, 100, 9);
  Model model = constant_model(data::StateLayout::kPose, {1e-3, -2e-3, 0.0}, dataset);
  const DynamicsEvaluation evaluation = evaluate_dynamics(model, dataset);
  REQUIRE(evaluation.predictions.has_value());
  CHECK(evaluation.predictions->size() > 100);
  CHECK(evaluation.predictions->size() <= 400);
  for (const runs::PredictedMotion& motion : *evaluation.predictions) {
    CHECK(motion.moved_mm[0] == Approx(3.0));
    CHECK(motion.moved_mm[1] == Approx(4.0));
    CHECK(motion.predicted_mm[0] == Approx(1.0).epsilon(1e-3));
    CHECK(motion.predicted_mm[1] == Approx(-2.0).epsilon(1e-3));
  }
}

TEST_CASE("the JSON has the keys that scripts read", "[unit]") {
  const data::Dataset dataset = marching(data::StateLayout::kPosition, 2, 3);
  Model model = constant_model(data::StateLayout::kPosition, {0.0, 0.0}, dataset);
  const common::Json json = common::artefact_to_json(evaluate_dynamics(model, dataset));
  CHECK_FALSE(json.contains("heading_rms_deg"));
  CHECK(json.at("k_step").at("10").is_null());
  CHECK(json.at("k_step").at("1").get<double>() == Approx(5.0));
  CHECK(json.at("baselines").at("knn10").contains("position_rms_mm"));
  CHECK(json.at("baselines").at("no_motion").at("position_rms_mm").get<double>() == Approx(5.0));
  CHECK(json.at("baselines").at("knn10_open_loop").at("k_step").at("1").get<double>() < 1e-3);
  CHECK(json.at("baselines").at("no_motion_open_loop").at("k_step").at("2").get<double>() == Approx(10.0));
  CHECK_FALSE(json.contains("k_step_heading_deg"));
  CHECK_FALSE(json.contains("region_coverage"));
  CHECK(json.at("n") == 6);
  CHECK(json.contains("normalised_l2"));
}

TEST_CASE("what is written reads back, and so does what was written before there were regions", "[unit]") {
  const data::Dataset dataset = marching(data::StateLayout::kPose, 2, 3);
  Model model = constant_model(data::StateLayout::kPose, {0.0, 0.0, 0.0}, dataset);
  DynamicsEvaluation evaluation = evaluate_dynamics(model, dataset);
  runs::RegionCoverage& coverage = evaluation.region_coverage.emplace();
  coverage.n = 2000;
  coverage.position[90].fraction = 0.875;
  coverage.position[90].interval = {0.86, 0.89};
  coverage.pose = coverage.position;
  const common::Json json = common::artefact_to_json(evaluation);
  CHECK(json.at("k_step_heading_deg").at("10").is_null());
  CHECK(json.at("region_coverage").at("position_and_heading").at("90").at("fraction") == 0.875);
  CHECK(json.at("region_coverage").at("position").at("90").at("interval").at(1) == 0.89);
  const auto again = common::artefact_from_json<DynamicsEvaluation>(json, "evaluation.json");
  CHECK(common::artefact_to_json(again) == json);

  const common::Json before = common::Json::parse(
      R"({"position_rms_mm": 2.5, "heading_rms_deg": 18.0, "k_step": {"1": 2.5, "10": null},
          "baselines": {"no_motion": {"position_rms_mm": 10.5}, "knn10": {"position_rms_mm": 3.75}},
          "error_map": []})");
  const auto old = common::artefact_from_json<DynamicsEvaluation>(before, "evaluation.json");
  CHECK(old.open_loop.k_step_mm->at(1).value() == 2.5);
  CHECK_FALSE(old.open_loop.k_step_heading_deg.has_value());
  CHECK_FALSE(old.baselines->nearest_neighbours_open_loop.has_value());
  CHECK_FALSE(old.region_coverage.has_value());
  CHECK(common::artefact_to_json(old) == before);
}

TEST_CASE("the test split is the one of the training, and layouts must agree", "[unit]") {
  const data::Dataset dataset = tests::known_dataset(data::StateLayout::kPosition, 50, 4, 5);
  Model model = constant_model(data::StateLayout::kPosition, {0.0, 0.0}, dataset);
  model.split = {77, 0.2, 0.1};
  const data::Dataset expected = data::split_by_episode(dataset, 0.2, 0.1, 77).test;
  const data::Dataset test = test_split(model, dataset);
  REQUIRE(test.episodes.size() == expected.episodes.size());
  CHECK(test.episodes[0].observations == expected.episodes[0].observations);
  CHECK_THROWS_AS(evaluate_dynamics(model, marching(data::StateLayout::kPose, 1, 2)), common::DataError);
}

TEST_CASE("data of another kind of drive are refused, where both say what they are of", "[unit]") {
  data::Dataset dataset = marching(data::StateLayout::kPosition, 2, 3);
  Model model = constant_model(data::StateLayout::kPosition, {0.0, 0.0}, dataset);
  dataset.info.rig = {{"drive", {{"kind", "opposed_pairs"}}}};
  CHECK_NOTHROW(evaluate_dynamics(model, dataset));
  model.info.rig = {{"drive", {{"kind", "field"}}}};
  CHECK_THROWS_WITH(evaluate_dynamics(model, dataset),
                    Catch::Contains("rig.drive.kind = \"field\", not \"opposed_pairs\""));
}

}  // namespace
}  // namespace lodestone::dynamics
