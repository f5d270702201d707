#include "lodestone/experiments/adaptation_run.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/experiments/collection_run.h"

namespace lodestone::experiments {

SimulatorSource load_start(const rig::RigConfig& rig, const std::string& folder) {
  DeploymentConfig deployment;
  deployment.rig = rig;
  deployment.identification.enabled = false;  // that it cannot be is an error here, no warning
  SimulatorSource source = load_simulator(deployment, folder);
  if (!source.simulator->sampled)
    throw common::ConfigError("adapt: " + folder +
                              " predicts single values; begin with a simulator that predicts distributions "
                              "(model.components of 1 or more), or --from-scratch");
  return source;
}

runs::Adaptation AdaptationRun::run() {
  const common::SteadyClock clock;
  const double start_s = clock.now_s();
  std::string data;
  std::string simulator = config_.dynamics;
  std::int64_t left = config_.pulses();
  if (config_.from_scratch) {
    const auto explored = static_cast<std::int64_t>(std::ceil(config_.explored * static_cast<double>(left)));
    left -= explored;
    data = record("exploring", explored, nullptr);
    if (left > 0) simulator = learn("first", learning_from(data, "", 0.0));
  }
  if (left > 0) {
    const SimulatorSource source = load_start(config_.collection.rig, simulator);
    data += (data.empty() ? "" : ",") + record("driving", left, &source);
  }
  const data::Dataset recorded = data::read_recordings(data);
  // What is held back tells nothing, not even the gain.
  const dynamics::DataSplit split = dynamics::split_of(learning_from(data, config_.dynamics, 0.0));
  const data::Split parts =
      data::split_by_episode(recorded, split.validation_fraction, split.test_fraction, split.seed);
  std::optional<SimulatorSource> before;
  double log_gain = 0.0;
  if (!config_.from_scratch) {
    before = load_start(config_.collection.rig, config_.dynamics);
    log_gain = identify(*before, config_.identification, parts.train).log_mean;
  }
  const std::string learned = learn("learning", learning_from(data, config_.dynamics, log_gain));
  runs::Adaptation result = compare(before ? &*before : nullptr, load_start(config_.collection.rig, learned),
                                    config_.identification, parts.train, parts.test);
  result.from = config_.dynamics;
  result.pulses = recorded.transitions();
  result.placements = recorded.placements();
  result.rig_minutes = static_cast<double>(result.pulses) * config_.collection.loop.period_s() / 60.0;
  result.seconds = clock.now_s() - start_s;
  if (before && result.kept) keep_before(run_.path(), config_.dynamics);
  put_model(run_.path(), result.kept ? learned : config_.dynamics);
  common::write_artefact(run_.file(runs::Adaptation::kFile), result);
  return result;
}

std::string AdaptationRun::record(const std::string& stage, std::int64_t pulses,
                                  const SimulatorSource* simulator) {
  CollectionConfig config = config_.collection;
  config.transitions = pulses;
  const bool repeatable = !config.rig.real();
  runs::RunRequest request{run_.file(stage), "collect", common::config_to_json(config), config.seed, true};
  request.free_keys = {"checkpoint_every_s", "rig.serial.port"};
  runs::RunFolder folder(request);
  const std::string recording = folder.file(data::kRecordingFile);
  if (folder.finished()) return recording;
  std::optional<Teleoperator> driver;
  if (simulator != nullptr)
    driver = goal_seeking(config, *simulator, config_.planner, config_.identification, config_.seek);
  Sessions sessions;
  sessions.push_back(std::make_unique<Collection>(config, bench_(), std::move(driver)));
  run_.begin();  // nothing is left behind where a simulator or a bench is missing
  CollectionRun work(config, sessions, repeatable, 1, folder.path());
  try {
    runs::run_resumably(folder, work, {stage, "pulses", repeatable ? config.checkpoint_every_s : 0.0});
  } catch (const common::Interrupted&) {
    say_stopped();
  }
  summarise_recording(folder);
  folder.finish();
  return recording;
}

dynamics::TrainDynamicsConfig AdaptationRun::learning_from(const std::string& data, const std::string& from,
                                                           double log_gain) const {
  dynamics::TrainDynamicsConfig config;
  config.seed = config_.collection.seed;
  config.threads = config_.threads;
  config.data = data;
  config.model = config_.model;
  config.training = from.empty() ? config_.first : config_.learning;
  config.warm_start = {from, std::exp(log_gain), config_.rehearsal};
  return dynamics::adopt_start(config);
}

std::string AdaptationRun::learn(const std::string& stage, const dynamics::TrainDynamicsConfig& config) {
  runs::RunFolder folder(dynamics::run_request(config, run_.file(stage), true));
  run_.begin();
  if (!folder.finished()) {
    try {
      dynamics::train_into(folder, data::read_recordings(config.data), config);
    } catch (const common::Interrupted&) {
      say_stopped();
    }
  }
  return folder.file("checkpoint");
}

void AdaptationRun::say_stopped() const {
  throw common::Interrupted("adapt: stopped; the same command with --resume goes on in " + run_.path());
}

}  // namespace lodestone::experiments
