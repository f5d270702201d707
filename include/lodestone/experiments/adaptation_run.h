#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "lodestone/dynamics/training.h"
#include "lodestone/experiments/adaptation.h"
#include "lodestone/experiments/collection.h"
#include "lodestone/experiments/seeking.h"
#include "lodestone/runs/adaptation_results.h"
#include "lodestone/runs/resumable_run.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::experiments {

/// How a rig is learned from its own pulses.
struct AdaptationConfig {
  CollectionConfig collection;
  std::int64_t threads = 0;
  std::string dynamics;
  bool from_scratch = false;
  double minutes = 0.0;
  double explored = 0.34;
  control::GoalSeekerConfig seek;
  control::PlannerConfig planner;
  control::IdentificationConfig identification;
  inference::DynamicsConfig model;
  dynamics::TrainingConfig first;
  dynamics::TrainingConfig learning;
  double rehearsal = 0.5;

  /// Networks and learning as in the best presets.
  AdaptationConfig() {
    collection.transitions = 1000;
    model.form = inference::DynamicsForm::kDelta;
    model.hidden = {256, 128, 32};
    model.batch_norm = false;
    model.members = 4;
    model.components = 3;
    first.epochs = 120;
    first.batch_size = 128;
    first.optimiser = dynamics::Optimiser::kAdamW;
    first.learning_rate = 2e-3;
    first.weight_decay = 0.01;
    first.schedule = dynamics::Schedule::kCosine;
    learning = first;
    learning.epochs = 6;
    learning.learning_rate = 3e-4;
    learning.test_fraction = 0.25;
    first.test_fraction = 0.25;
  }

  template <class Visitor>
  void visit(Visitor& v) {
    collection.visit(v);
    v.field("threads", threads, "", "threads that learn; 0 means one per processor", {0, 1024});
    v.field("dynamics", dynamics, "", "folder of the simulator to begin with");
    v.field("from_scratch", from_scratch, "", "begin with nothing: explore first");
    v.field("minutes", minutes, "min",
            "of pulses on the rig, instead of `transitions`; 0: as many as those say", {0.0, 1e5});
    v.field("explored", explored, "",
            "from scratch, the share of the pulses that explore before anything is known", {0.05, 1.0});
    v.group("seek", seek, "where it drives to meanwhile");
    v.group("planner", planner, "how it drives there");
    v.group("identification", identification, "what the pulses say about the rig");
    v.group("model", model, "from scratch, the networks");
    v.group("first", first, "from scratch, how they learn");
    v.group("learning", learning, "how the simulator goes on learning");
    v.field("rehearsal", rehearsal, "",
            "share of what the simulator had learned from before among what it learns from", {0.0, 0.99});
  }
  void validate() const {
    if (collection.sessions != 1)
      throw common::InvalidConfig("sessions", collection.sessions,
                                  "be 1: it adapts to one rig, pulse by pulse");
    if (from_scratch && model.components < 1)
      throw common::InvalidConfig("model.components", model.components,
                                  "be at least 1: rigs are identified by predicted distributions");
    constexpr std::int64_t kEpisodes = 8;  // of which some teach, some choose and some judge
    const double known_from = (from_scratch ? explored : 1.0) * static_cast<double>(pulses());
    if (known_from < static_cast<double>(kEpisodes * collection.episode_steps))
      throw common::InvalidConfig(
          "transitions", pulses(),
          "be enough for " + std::to_string(kEpisodes) + " episodes of episode_steps = " +
              std::to_string(collection.episode_steps) + (from_scratch ? " while it explores" : ""));
  }

  std::int64_t pulses() const {
    if (minutes <= 0.0) return collection.transitions;
    return std::max<std::int64_t>(1, std::llround(60.0 * minutes / collection.loop.period_s()));
  }
};

/// Reads a simulator that can be gone on from: it predicts distributions. Throws ConfigError where it does
/// not, and as load_simulator.
SimulatorSource load_start(const rig::RigConfig& rig, const std::string& folder);

/// Learns a rig from its own pulses, which it drives while it records them: in stages with folders of their
/// own below the run's, each of which goes on where it was when the run is begun again.
class AdaptationRun {
 public:
  using MakeBench = std::function<std::unique_ptr<session::RigSession>()>;

  /// `bench` makes the rig, once for every stage that drives. Both references must outlive it.
  AdaptationRun(const AdaptationConfig& config, runs::RunFolder& run, MakeBench bench)
      : config_(config), run_(run), bench_(std::move(bench)) {}

  /// Drives, learns, compares, and puts the simulator that shall be used into folder `model` of the run.
  /// Throws Interrupted, after what was reached is on the disk, and as its stages do.
  runs::Adaptation run();

 private:
  /// Records pulses: explores, or goes from target to target by planning. Returns the recording.
  std::string record(const std::string& stage, std::int64_t pulses, const SimulatorSource* simulator);
  /// How a simulator learns from recordings, going on from another where one is named.
  dynamics::TrainDynamicsConfig learning_from(const std::string& data, const std::string& from,
                                              double log_gain) const;
  /// Learns one. Returns its checkpoint.
  std::string learn(const std::string& stage, const dynamics::TrainDynamicsConfig& config);
  [[noreturn]] void say_stopped() const;

  const AdaptationConfig& config_;
  runs::RunFolder& run_;
  MakeBench bench_;
};

}  // namespace lodestone::experiments
