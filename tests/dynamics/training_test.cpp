#include "lodestone/dynamics/training.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <limits>

#include <ATen/ATen.h>

#include "dynamics/synthetic_motion.h"
#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/dynamics/evaluation.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/physics/rig_description.h"
#include "temporary_folder.h"

namespace lodestone::dynamics {
namespace {

using Catch::Contains;
using inference::DynamicsForm;
using inference::Symmetry;
using tests::known_dataset;

TrainDynamicsConfig small_config(inference::DynamicsForm form) {
  TrainDynamicsConfig config;
  config.seed = 3;
  config.threads = 1;
  config.model.form = form;
  config.model.hidden = {32, 16};
  config.model.batch_norm = form == DynamicsForm::kPaper;
  config.training.epochs = 4;
  config.training.batch_size = 64;
  if (form == DynamicsForm::kDelta) {
    config.training.optimiser = Optimiser::kAdamW;
    config.training.learning_rate = 3e-3;
    config.training.weight_decay = 1e-3;
    config.training.schedule = Schedule::kCosine;
    config.training.loss = Loss::kHuber;
  }
  return config;
}

/// Parameters and buffers of every member, equal only when bitwise equal.
bool same_networks(const Model& a, const Model& b) {
  for (std::size_t k = 0; k < a.members.size(); ++k) {
    const auto left = a.members[k]->tensors().named();
    const auto right = b.members[k]->tensors().named();
    for (const auto& [name, tensor] : left) {
      if (!at::equal(tensor, right.at(name))) return false;
    }
  }
  return a.members.size() == b.members.size();
}

TrainingResult train(const data::Dataset& dataset, const TrainDynamicsConfig& config,
                     const std::string& folder, bool resume) {
  runs::RunFolder run(run_request(config, folder, resume));
  return train_dynamics(dataset, config, run);
}

TrainingResult train(const data::Dataset& dataset, const TrainDynamicsConfig& config) {
  const ::lodestone::tests::TemporaryFolder temporary;
  return train(dataset, config, temporary / "run", false);
}

}  // namespace

TEST_CASE("both forms learn a known motion", "[unit]") {
  for (const auto form : {DynamicsForm::kPaper, DynamicsForm::kDelta}) {
    for (const auto layout : {data::StateLayout::kPose, data::StateLayout::kPosition}) {
      CAPTURE(common::name_of(form), data::state_size(layout));
      TrainDynamicsConfig config = small_config(form);
      config.training.epochs = 20;
      const data::Dataset dataset = known_dataset(layout, 150, 20, 1);
      TrainingResult result = train(dataset, config);
      const DynamicsEvaluation evaluation =
          evaluate_dynamics(result.model, test_split(result.model, dataset));
      CHECK(evaluation.one_step.position_rms_mm < 0.8 * evaluation.baselines->no_motion.position_rms_mm);
      // The change form knows that it starts where it is, so it must be far better.
      if (form == DynamicsForm::kDelta) {
        CHECK(evaluation.one_step.position_rms_mm < 0.1 * evaluation.baselines->no_motion.position_rms_mm);
      }
      CHECK(result.facts.validation_loss < 0.2);
    }
  }
}

TEST_CASE("every optimiser lowers the loss", "[unit]") {
  const data::Dataset dataset = known_dataset(data::StateLayout::kPosition, 60, 20, 1);
  for (const auto optimiser : {Optimiser::kSgd, Optimiser::kAdam, Optimiser::kAdamW}) {
    TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
    config.training.optimiser = optimiser;
    config.training.loss = Loss::kL2;
    config.training.epochs = 1;
    const double early = train(dataset, config).facts.validation_loss;
    config.training.epochs = 10;
    CAPTURE(common::name_of(optimiser));
    CHECK(train(dataset, config).facts.validation_loss < 0.7 * early);
  }
}

TEST_CASE("training depends on the seed and not on threads", "[unit]") {
  const data::Dataset dataset = known_dataset(data::StateLayout::kPose, 40, 20, 1);
  TrainDynamicsConfig config = small_config(DynamicsForm::kPaper);
  config.model.members = 3;
  config.training.bootstrap = true;
  const TrainingResult one = train(dataset, config);
  for (const std::int64_t threads : {2, 4}) {
    config.threads = threads;
    CHECK(same_networks(one.model, train(dataset, config).model));
  }
  config.seed = 4;
  CHECK_FALSE(same_networks(one.model, train(dataset, config).model));
}

TEST_CASE("a stopped training goes on bitwise", "[unit]") {
  const data::Dataset dataset = known_dataset(data::StateLayout::kPose, 40, 20, 1);
  for (const auto form : {DynamicsForm::kPaper, DynamicsForm::kDelta}) {
    const ::lodestone::tests::TemporaryFolder temporary;
    TrainDynamicsConfig config = small_config(form);
    config.model.members = 2;
    (form == DynamicsForm::kDelta ? config.training.symmetry : config.model.symmetry) = Symmetry::kSquare;
    const TrainingResult whole = train(dataset, config);
    TrainDynamicsConfig stopped = config;
    stopped.training.max_seconds = 1e-9;  // after one epoch
    CHECK(train(dataset, stopped, temporary / "run", false).facts.epochs == 1);
    CHECK(train(dataset, stopped, temporary / "run", true).facts.epochs == 2);
    // A row that a killed run wrote after its last checkpoint is not written twice.
    std::ofstream(temporary / "run/metrics.jsonl", std::ios::app) << "{\"step\": 3, \"train_loss\": 1.0}\n";
    const TrainingResult resumed = train(dataset, config, temporary / "run", true);
    CHECK(resumed.facts.epochs == config.training.epochs);
    CHECK(same_networks(whole.model, resumed.model));
    CHECK(whole.facts.validation_loss == resumed.facts.validation_loss);
    std::ifstream metrics(temporary / "run/metrics.jsonl");
    std::int64_t step = 0;
    for (std::string line; std::getline(metrics, line);) {
      CHECK(common::Json::parse(line).at("step") == ++step);
      CHECK(common::Json::parse(line).contains("validation_loss"));
    }
    CHECK(step == config.training.epochs);
  }
}

TEST_CASE("resuming with other settings or other data is refused", "[unit]") {
  const ::lodestone::tests::TemporaryFolder temporary;
  const data::Dataset dataset = known_dataset(data::StateLayout::kPosition, 40, 10, 1);
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.epochs = 1;
  train(dataset, config, temporary / "run", false);
  TrainDynamicsConfig other = config;
  other.training.learning_rate *= 2.0;
  CHECK_THROWS_WITH(train(dataset, other, temporary / "run", true), Contains("other settings"));
  CHECK_THROWS_WITH(
      train(known_dataset(data::StateLayout::kPosition, 40, 10, 2), config, temporary / "run", true),
      Contains("other transitions"));
}

TEST_CASE("of a rig that looks the same from eight sides, one side tells of all", "[unit]") {
  const data::Dataset all = known_dataset(data::StateLayout::kPose, 150, 20, 1);
  data::Dataset one_sided = all;  // pulses between 0 and 45 degrees alone
  one_sided.episodes.clear();
  const data::TransitionTable table = data::flatten(all);
  for (std::size_t row = 0; row < static_cast<std::size_t>(table.size()); ++row) {
    const double* drive = &table.action[2 * row];
    if (drive[1] < 0.0 || drive[1] > drive[0]) continue;
    data::Episode& episode = one_sided.episodes.emplace_back();
    episode.observations.assign(&table.state[3 * row], &table.state[3 * row] + 3);
    episode.observations.insert(episode.observations.end(), &table.next_state[3 * row],
                                &table.next_state[3 * row] + 3);
    episode.actions.assign(drive, drive + 2);
    episode.terminations = episode.zero_current = {0};
    episode.truncations = {1};
  }
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.epochs = 60;
  const auto error_mm = [&](Symmetry seen, Symmetry built_in) {
    config.training.symmetry = seen;
    config.model.symmetry = built_in;
    return evaluate_dynamics(train(one_sided, config).model, all).one_step.position_rms_mm;
  };
  const double without_mm = error_mm(Symmetry::kNone, Symmetry::kNone);
  CHECK(error_mm(Symmetry::kSquare, Symmetry::kNone) < 0.5 * without_mm);
  CHECK(error_mm(Symmetry::kNone, Symmetry::kSquare) < 0.5 * without_mm);
}

TEST_CASE("what of a rig differs from side to side is learned where its symmetry is not exact", "[unit]") {
  data::Dataset lopsided = known_dataset(data::StateLayout::kPose, 150, 20, 1);
  const data::TransitionTable table = data::flatten(lopsided);
  lopsided.episodes.clear();
  for (std::size_t row = 0; row < static_cast<std::size_t>(table.size()); ++row) {
    const double* state = &table.state[3 * row];
    data::Episode& episode = lopsided.episodes.emplace_back();
    episode.observations.assign(state, state + 3);
    const double times = state[0] > 0.0 ? 2.0 : 1.0;  // the east pulls twice as hard
    for (int i = 0; i < 2; ++i)
      episode.observations.push_back(state[i] + times * (table.next_state[3 * row + i] - state[i]));
    episode.observations.push_back(table.next_state[3 * row + 2]);
    episode.actions.assign(&table.action[2 * row], &table.action[2 * row] + 2);
    episode.terminations = episode.zero_current = {0};
    episode.truncations = {1};
  }
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.epochs = 60;
  config.model.symmetry = Symmetry::kSquare;
  const auto error_mm = [&](bool exact) {
    config.model.symmetry_exact = exact;
    const TrainingResult result = train(lopsided, config);
    return evaluate_dynamics(result.model, test_split(result.model, lopsided)).one_step.position_rms_mm;
  };
  CHECK(error_mm(false) < 0.75 * error_mm(true));
}

TEST_CASE("pulses that are shown from all sides alike tell nothing of what differs between them", "[unit]") {
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.symmetry = config.model.symmetry = Symmetry::kSquare;
  config.model.symmetry_exact = false;
  CHECK_THROWS_WITH(train(known_dataset(data::StateLayout::kPose, 20, 10, 1), config),
                    Contains("training.symmetry") && Contains("model.symmetry_exact"));
}

TEST_CASE("drives that are no vectors are not turned", "[unit]") {
  data::Dataset dataset = known_dataset(data::StateLayout::kPose, 40, 20, 1);
  dataset.info.action_size = 1;
  for (data::Episode& episode : dataset.episodes) episode.actions.resize(episode.actions.size() / 2);
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.symmetry = Symmetry::kSquare;
  CHECK_THROWS_WITH(train(dataset, config), Contains("training.symmetry") && Contains("say none"));
  config.training.symmetry = Symmetry::kNone;
  config.model.symmetry = Symmetry::kSquare;
  CHECK_THROWS_WITH(train(dataset, config), Contains("model.symmetry") && Contains("say none"));
}

TEST_CASE("NaN in the data is an error that says where", "[unit]") {
  data::Dataset dataset = known_dataset(data::StateLayout::kPose, 20, 10, 1);
  dataset.episodes[7].observations[4] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(train(dataset, small_config(DynamicsForm::kDelta)), common::DataError);
}

TEST_CASE("a diverging training says what to do", "[unit]") {
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.optimiser = Optimiser::kSgd;
  config.training.loss = Loss::kL2;
  config.training.learning_rate = 10.0;
  config.training.epochs = 50;
  CHECK_THROWS_WITH(train(known_dataset(data::StateLayout::kPose, 60, 20, 1), config),
                    Contains("lower training.learning_rate"));
}

TEST_CASE("patience ends members that only learn noise, and the best weights are kept", "[unit]") {
  data::Dataset dataset = known_dataset(data::StateLayout::kPosition, 30, 10, 1);
  common::RandomStream random(1, "noise");
  for (data::Episode& episode : dataset.episodes) {
    for (double& value : episode.observations) value = random.uniform(-0.03, 0.03);
  }
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.epochs = 300;
  config.training.learning_rate = 1e-2;
  config.training.schedule = Schedule::kConstant;
  const double kept = train(dataset, config).facts.validation_loss;
  config.training.patience = 5;
  const TrainingResult patient = train(dataset, config);
  CHECK(patient.facts.epochs < 300);
  CHECK(patient.facts.validation_loss >= kept);
  config.training.keep_best = false;
  CHECK(train(dataset, config).facts.validation_loss > patient.facts.validation_loss);
}

TEST_CASE("a mixture learns that the robot stays or jumps, which a mean hides", "[unit]") {
  data::Dataset dataset;
  dataset.info.layout = data::StateLayout::kPosition;
  dataset.info.workspace_radius_m = 0.0425;
  common::RandomStream random(1, "jumps");
  for (int e = 0; e < 60; ++e) {
    data::Episode episode;
    double x_m = random.uniform(-0.01, 0.01);
    episode.observations = {x_m, 0.0};
    for (int t = 0; t < 20; ++t) {
      x_m += random.uniform() < 0.5 ? 0.0 : 0.004;  // it moves every other time, whatever the drive
      episode.observations.insert(episode.observations.end(), {x_m, 1e-4 * random.normal()});
      episode.actions.insert(episode.actions.end(), {5.0, 1.0});
      episode.terminations.push_back(0);
      episode.truncations.push_back(t == 19 ? 1 : 0);
      episode.zero_current.push_back(0);
    }
    dataset.episodes.push_back(episode);
  }
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.model.components = 2;
  config.training.epochs = 60;
  const TrainingResult result = train(dataset, config);
  const inference::FoldedDynamics folded = fold(*result.model.members.front());
  inference::FoldedDynamics::Workspace workspace;
  int stayed = 0;
  int jumped = 0;
  constexpr int kDraws = 1000;
  for (int i = 0; i < kDraws; ++i) {
    const double state[2] = {0.001, 0.0};
    const double drive[2] = {5.0, 1.0};
    double next[2];
    common::RandomStream* stream = &random;
    folded.sample(state, drive, 1, &stream, next, workspace);
    if (std::abs(next[0] - 0.001) < 0.0008) ++stayed;
    if (std::abs(next[0] - 0.005) < 0.0008) ++jumped;
  }
  CHECK(stayed > 0.35 * kDraws);
  CHECK(jumped > 0.35 * kDraws);
  CHECK(stayed + jumped > 0.9 * kDraws);
  const DynamicsEvaluation evaluation = evaluate_dynamics(result.model, dataset);
  REQUIRE(evaluation.region_coverage.has_value());
  CHECK(evaluation.region_coverage->n == evaluation.n.value());
  CHECK_FALSE(evaluation.region_coverage->pose.has_value());
}

TEST_CASE("learning goes on from a model as its rig would be, were it as strong", "[unit]") {
  const ::lodestone::tests::TemporaryFolder temporary;
  const data::Dataset known = known_dataset(data::StateLayout::kPose, 60, 20, 1);
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.epochs = 20;
  const TrainingResult first = train(known, config);
  save_model(temporary / "model", first.model, common::config_to_json(config), {});
  // The same motions on a rig that takes half the current for them.
  data::Dataset strong = known_dataset(data::StateLayout::kPose, 30, 20, 2);
  for (data::Episode& episode : strong.episodes)
    for (double& drive : episode.actions) drive /= 2.0;
  config.model.hidden = {7};  // the model's own are taken
  config.warm_start = {temporary / "model", 2.0, 0.5};
  config.training.epochs = 1;
  config.training.learning_rate = 1e-8;
  config = adopt_start(config);
  CHECK(config.model.hidden == first.model.config.hidden);
  const TrainingResult second = train(strong, config);
  const double as_it_was = evaluate_dynamics(first.model, known_dataset(data::StateLayout::kPose, 30, 20, 2))
                               .one_step.position_rms_mm;
  CHECK(evaluate_dynamics(second.model, strong).one_step.position_rms_mm == Approx(as_it_was).epsilon(0.02));
  const std::int64_t rows = first.model.training_rows.state.shape()[0];
  CHECK(second.model.training_rows.state.shape()[0] > rows);
  CHECK(second.model.training_rows.action.to_double().front() ==
        Approx(first.model.training_rows.action.to_double().front() / 2.0));
  config.warm_start.drive_gain = 1.0;
  CHECK(evaluate_dynamics(train(strong, config).model, strong).one_step.position_rms_mm > 2.0 * as_it_was);
  data::Dataset other = strong;
  other.info.action_scale += 1.0;
  CHECK_THROWS_WITH(train(other, config), Contains("warm_start.from"));
}

TEST_CASE("a model of exact symmetry goes on with a rig whose coils differ", "[unit]") {
  const ::lodestone::tests::TemporaryFolder temporary;
  data::Dataset dataset = known_dataset(data::StateLayout::kPose, 20, 20, 1);
  TrainDynamicsConfig config = small_config(DynamicsForm::kDelta);
  config.training.epochs = 1;
  config.model.symmetry = Symmetry::kSquare;
  const TrainingResult first = train(dataset, config);
  save_model(temporary / "model", first.model, common::config_to_json(config), {});
  physics::RigDescription rig;
  rig.coils.resistance_20C_ohm.back() *= 1.02;
  dataset.info.rig = common::config_to_json(rig);
  CHECK_THROWS_WITH(train(dataset, config), Contains("four coils differ"));  // from nothing
  config.warm_start.from = temporary / "model";
  CHECK(train(dataset, adopt_start(config)).model.config.symmetry == Symmetry::kSquare);
}

}  // namespace lodestone::dynamics
