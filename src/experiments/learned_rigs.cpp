#include "lodestone/experiments/learned_rigs.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/statistics.h"

namespace lodestone::experiments {
namespace {

constexpr int kSeedBits = 52;  // a seed in a configuration is a whole number that JSON holds exactly

/// The bench of a rig, as it will be driven.
std::unique_ptr<session::RigSession> make_session(const CollectionConfig& config, const UnseenRig& rig) {
  session::VirtualSeeds seeds;
  seeds.rig = rig.seed;
  seeds.scene = rig.scene;
  const auto seed = static_cast<std::uint64_t>(config.seed);
  seeds.sensor_noise = common::RandomStream(seed, "learn a rig/sensor noise");
  seeds.scatter = common::RandomStream(seed, "learn a rig/scatter");
  return session::make_virtual_session(rig.config, config.sensor, config.safety, seeds, false);
}

ControllerSource learn(const RigLearner& learner, const DeployConfig& config, const std::string& folder,
                       const std::string& task, std::int64_t trial) {
  const std::int64_t rig = trial / config.deployment.trials.per_rig;
  const AdaptationConfig adaptation = adaptation_of(learner, config, rig);
  runs::RunFolder run({adaptation_folder(learner, folder, rig), "adapt", common::config_to_json(adaptation),
                       adaptation.collection.seed, true});
  if (!run.finished()) {
    const UnseenRig unseen = unseen_rig(config.deployment, task, trial);
    AdaptationRun(adaptation, run, [&] { return make_session(adaptation.collection, unseen); }).run();
    run.finish();
  }
  ControllerSource source =
      planner_source(config.deployment, load_simulator(config.deployment, run.file("model")));
  source.name = learner.name();
  return source;
}

}  // namespace

std::string RigLearner::name() const {
  return (from_scratch ? "from_scratch_" : "adapted_") + std::to_string(pulses);
}

AdaptationConfig adaptation_of(const RigLearner& learner, const DeployConfig& config, std::int64_t rig) {
  const DeploymentConfig& deployment = config.deployment;
  AdaptationConfig adaptation;
  CollectionConfig& collection = adaptation.collection;
  collection.transitions = learner.pulses;
  collection.seed =
      static_cast<std::int64_t>(common::derive_seed(static_cast<std::uint64_t>(deployment.seed),
                                                    learner.name(), static_cast<std::uint64_t>(rig)) >>
                                (64 - kSeedBits));
  collection.loop = deployment.loop;
  collection.safety = deployment.safety;
  collection.rig = deployment.rig;
  collection.sensor = deployment.sensor;
  adaptation.planner = deployment.planner;
  adaptation.identification = deployment.identification;
  adaptation.threads = config.threads;
  adaptation.from_scratch = learner.from_scratch;
  if (!learner.from_scratch) adaptation.dynamics = config.dynamics;
  return adaptation;
}

std::string adaptation_folder(const RigLearner& learner, const std::string& folder, std::int64_t rig) {
  return folder + "/" + learner.name() + "/rig_" + std::to_string(rig);
}

TrialDriver learning_driver(TrialDriver driver, const std::vector<RigLearner>& learners,
                            const DeployConfig& config, const std::string& folder) {
  if (learners.empty()) return driver;
  const auto per_rig = static_cast<std::size_t>(config.deployment.trials.per_rig);
  driver.batch = per_rig * ((driver.batch + per_rig - 1) / per_rig);
  driver.drive = [=, inner = driver.drive](const std::vector<TrialPlan>& plans, RigKind kind,
                                           const ControllerSource& source, const TrialWatch& watch) {
    const auto learner = std::find_if(learners.begin(), learners.end(),
                                      [&](const RigLearner& one) { return one.name() == source.name; });
    if (learner == learners.end()) return inner(plans, kind, source, watch);
    std::vector<TrialResult> results;
    for (auto first = plans.begin(); first != plans.end();) {
      const std::int64_t rig = first->index / config.deployment.trials.per_rig;
      const auto last = std::find_if(first, plans.end(), [&](const TrialPlan& plan) {
        return plan.index / config.deployment.trials.per_rig != rig;
      });
      const ControllerSource learned = learn(*learner, config, folder, first->task, first->index);
      for (TrialResult& result : inner({first, last}, kind, learned, watch))
        results.push_back(std::move(result));
      first = last;
    }
    return results;
  };
  return driver;
}

runs::LearnedRigs summarise_learned(const RigLearner& learner, const std::string& folder, std::int64_t rigs) {
  runs::LearnedRigs summary;
  summary.pulses = learner.pulses;
  std::vector<double> seconds;
  for (std::int64_t rig = 0; rig < rigs; ++rig) {
    const std::string file = adaptation_folder(learner, folder, rig) + "/" + runs::Adaptation::kFile;
    if (!std::filesystem::exists(file)) continue;
    const auto adaptation = common::read_artefact<runs::Adaptation>(file);
    ++summary.rigs;
    summary.kept += adaptation.kept ? 1 : 0;
    summary.placements += adaptation.placements;
    summary.rig_minutes = adaptation.rig_minutes;
    seconds.push_back(adaptation.seconds);
  }
  if (!seconds.empty()) summary.median_seconds = common::median(seconds);
  return summary;
}

}  // namespace lodestone::experiments
