#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/experiments/bounded_figure.h"
#include "lodestone/experiments/deployment.h"

namespace lodestone::experiments {

/// What `bench tracking` measures, and what it must keep to.
struct TrackingBenchConfig {
  DeploymentConfig deployment;
  std::int64_t threads = 0;
  std::int64_t transitions = 20000;
  std::int64_t spoiled_trials = 100;
  std::string dynamics;

  template <class Visitor>
  void visit(Visitor& v) {
    deployment.visit(v);
    v.field("threads", threads, "", "trials at the same time; 0 means one per processor", {0, 1024});
    v.field("transitions", transitions, "", "steps of the explorer whose tape is masked", {100, 1e7});
    v.field("spoiled_trials", spoiled_trials, "",
            "squares on the explored rig for each way in which the simulated localiser fails", {1, 1e6});
    v.field("dynamics", dynamics, "",
            "folder of the dynamics checkpoint that the planner, which drives, plans in; empty: the "
            "proportional baseline drives");
  }
  void validate() const { deployment.rig.validate(); }
};

/// Steps with current whose tape was masked: the head before is known, the axis after is seen.
struct MaskedTape {
  std::int64_t steps = 0;
  std::int64_t undecided = 0, wrong = 0;  ///< of those that were decided
  std::int64_t wrong_by_nearest = 0;  ///< where the end nearest to the old heading were taken, of all steps
  double wrong_share = 0.0, undecided_share = 0.0;
  std::array<double, 2> wrong_interval = {}, undecided_interval = {};  ///< 95 %

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("steps", steps);
    v.field("undecided", undecided);
    v.field("wrong", wrong);
    v.field("wrong_by_nearest", wrong_by_nearest);
    v.field("wrong_share", wrong_share);
    v.field("undecided_share", undecided_share);
    v.field("wrong_interval", wrong_interval);
    v.field("undecided_interval", undecided_interval);
  }
};

/// Squares and circles on unseen rigs, by the sensor of the configuration.
struct TrackedTrials {
  std::int64_t trials = 0, observations = 0;
  std::int64_t unseen = 0;                   ///< observations without a pose
  std::int64_t undecided = 0;                ///< of these, with the axis seen, but not which end is the head;
  std::int64_t driven_undecided = 0;         ///< driven on all the same, as both ends asked for much the same
  std::int64_t flipped = 0;                  ///< poses with head and tail exchanged
  std::int64_t lost = 0;                     ///< trials that ended for want of a pose
  std::array<double, 2> lost_interval = {};  ///< 95 %, of the share
  double worst_mm = 0.0;                     ///< largest error of a pose
  double covered_share = 0.0;  ///< of the poses: true place within the region that shall hold 95 %
  double innovation = 0.0;     ///< mean normalised innovation; 2 where surprises are as large as expected

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("trials", trials);
    v.field("observations", observations);
    v.field("unseen", unseen);
    v.field("undecided", undecided);
    v.field("driven_undecided", driven_undecided);
    v.field("flipped", flipped);
    v.field("lost", lost);
    v.field("lost_interval", lost_interval);
    v.field("worst_mm", worst_mm);
    v.field("covered_share", covered_share);
    v.field("innovation", innovation);
  }
};

/// Squares under a simulated localiser that fails often.
struct SpoiledTrials {
  std::string how;
  TrackedTrials tracked;
  double success_share = 0.0;
  std::array<double, 2> success_interval = {};  ///< 95 %

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("how", how);
    v.field("tracked", tracked);
    v.field("success_share", success_share);
    v.field("success_interval", success_interval);
  }
};

/// `tracking.json`.
struct TrackingResult {
  static constexpr const char* kFile = "tracking.json";
  common::Json machine;
  std::optional<MaskedTape> masked_tape;  ///< steps of the explorer, which asks for fields of any direction
  std::optional<MaskedTape> masked_while_driven;  ///< steps of the trials
  std::optional<TrackedTrials> trials;
  std::vector<SpoiledTrials> spoiled;
  std::vector<BoundedFigure> figures;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("machine", machine);
    v.field("masked_tape", masked_tape);
    v.field("masked_while_driven", masked_while_driven);
    v.field("trials", trials);
    v.field("spoiled", spoiled);
    v.field("figures", figures);
  }
};

/// How well the needle is kept in sight. Throws Interrupted.
class TrackingBench {
 public:
  /// `config` must outlive the bench. Throws what reading its dynamics checkpoint does.
  explicit TrackingBench(const TrackingBenchConfig& config);

  /// Of steps of the explorer.
  void mask_tape();
  /// Unseen rigs, by the configured sensor; and of their steps, too.
  void drive();
  /// The explored rig, by a simulated localiser that misses, sees what is not there, or takes tail for head.
  void spoil();
  /// What needs no trials: a needle moved by hand, covered, or lying still; and what the tracker costs.
  void check();
  const TrackingResult& result() const { return result_; }

 private:
  void close(MaskedTape& masked, const std::string& where);

  void drive_spoiled(const std::string& how, const session::SensorErrorConfig& errors, double least_success);

  const TrackingBenchConfig& config_;
  ControllerSource source_;
  TrackingResult result_;
};

}  // namespace lodestone::experiments
