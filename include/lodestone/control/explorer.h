#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/control/controller.h"
#include "lodestone/control/freeing.h"
#include "lodestone/physics/coil_drive.h"

namespace lodestone::control {

/// How the rig is explored.
struct ExplorerConfig {
  double start_radius = 0.87;
  double cell_m = 0.0085;
  std::int64_t heading_bins = 8;
  std::int64_t level_bins = 5;
  std::int64_t candidates = 24;
  double single_axis_fraction = 0.3;
  double zero_fraction = 0.02;
  double min_drive = 0.1;
  double weak_fraction = 0.8;
  double weakest_drive = 0.0133;
  double steering = 2.0;
  bool self_reset = true;
  std::int64_t stuck_steps = 4;
  double stuck_threshold_m = 0.0015;
  double crowding = 1.5;
  FreeingConfig freeing;

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("dish_radius_m", "rig.dish.radius_m");
    v.retired("start_radius_m", "start_radius, in dish radii");
    v.field("start_radius", start_radius, "dish radii", "the operator places the needle within this radius",
            {0.0, 1.0});
    v.field("cell_m", cell_m, "m", "side of a cell of the visit counts", {1e-4, 1.0});
    v.field("heading_bins", heading_bins, "", "heading bins of the visit counts", {1, 360});
    v.field("level_bins", level_bins, "", "levels of each number of the drive, per sign, of the visit counts",
            {1, 100});
    v.field("candidates", candidates, "", "random actions the least visited is chosen from", {1, 10000});
    v.field("single_axis_fraction", single_axis_fraction, "",
            "fraction of candidates of which one number only is not zero", {0.0, 1.0});
    v.retired("single_axis_share", "single_axis_fraction");
    v.retired("zero_share", "zero_fraction");
    v.field("zero_fraction", zero_fraction, "", "fraction of steps without current", {0.0, 1.0});
    v.field("min_drive", min_drive, "", "smallest number of a drive, as a fraction of the largest",
            {0.0, 1.0});
    v.field("weak_fraction", weak_fraction, "",
            "fraction of candidates that are weakened, as fine motion near a goal needs them", {0.0, 1.0});
    v.field("weakest_drive", weakest_drive, "",
            "their largest number is log-uniform from this fraction of the largest current to all of it",
            {1e-4, 0.9});
    v.field("steering", steering, "", "weight of steering towards places seldom visited; 0 is off",
            {0.0, 100.0});
    v.field(
        "self_reset", self_reset, "",
        "an episode begins where the one before ended, a needle that is stuck is freed by pulses, and the "
        "operator places it only where they fail; false: the operator places it for every episode");
    v.field("stuck_steps", stuck_steps, "",
            "steps without motion after which the needle is freed, or placed by the operator", {1, 1000});
    v.field("crowding", crowding, "", "after one, where visits exceed the mean by this factor", {0.0, 1e6});
    v.field("stuck_threshold_m", stuck_threshold_m, "m", "a sensed step shorter than this is no motion",
            {0.0, 0.1});
    v.group("freeing", freeing, "how a needle that is stuck is freed");
  }
};

/// Guided exploration as a careful operator would do it: counts visits per position, heading and current,
/// remembers where currents took the needle from each place, and of some random actions takes the one tried
/// least here that leads to places seldom visited. Frees a needle that is stuck. Uses sensed poses only.
/// The target of an observation is ignored.
class Explorer final : public Controller {
 public:
  Explorer(const ExplorerConfig& config, const physics::RigDescription& rig, common::RandomStream random);

  /// A new episode of a needle that lies where it lay.
  void reset() override;
  geometry::Drive act(const task::Observation& observation) override;

  /// Where the operator puts the needle for the next episode: the least visited of some random places, any
  /// heading.
  /// `fits` says whether the needle would lie inside the dish wall, which an operator sees.
  geometry::Pose2 next_start(const std::function<bool(const geometry::Pose2&)>& fits);
  /// The operator has placed it.
  void placed();
  /// Time for the operator: the needle is stuck, and freeing it has failed, where that is tried.
  bool needs_operator() const { return config_.self_reset ? freeing_.failed() : stuck(); }

  /// Counts, freeing and random state, for bitwise resumption between two episodes.
  common::Json save() const;
  void restore(const common::Json& state);

 private:
  /// True when the needle has not moved for `stuck_steps` steps, or not at all in a crowded place such as the
  /// wall before a coil.
  bool stuck() const { return still_steps_ >= (crowded_ ? 1 : config_.stuck_steps); }
  void see(const geometry::Vector2& position_m);
  geometry::Drive decide(const geometry::Pose2& pose);
  void keep_count(const geometry::Pose2& pose, const geometry::Drive& action);
  geometry::Drive draw_action();
  /// The largest of an action's numbers that drive a coil.
  double strength(const geometry::Drive& action) const;
  std::int64_t cell_of(const geometry::Vector2& position_m) const;
  std::int64_t heading_of(double heading_rad) const;
  std::int64_t level_of(const geometry::Drive& action) const;
  double cost(const geometry::Pose2& pose, const geometry::Drive& action) const;
  double mean_visits() const;

  ExplorerConfig config_;
  double dish_radius_m_;
  physics::CoilDrive drive_;
  common::RandomStream random_;
  Freeing freeing_;
  std::int64_t side_ = 0;           // cells along a side of the grid
  std::int64_t levels_ = 0;         // bins of one number of a drive, signs and zero included
  std::int64_t action_levels_ = 0;  // of a whole one: of both of two numbers, else of the largest of them
  std::vector<std::int64_t> at_position_;        // [cell]
  std::vector<std::int64_t> at_pose_;            // [cell, heading]
  std::vector<std::int64_t> level_at_position_;  // [cell, level]
  std::vector<std::int64_t> level_at_heading_;   // [heading, level]
  std::vector<std::int64_t> led_to_;  // [cell, level]: the cell it last led to, -1 when never tried
  std::int64_t visits_ = 0;
  std::int64_t last_index_ = -1;  // entry of led_to_ that the next observation answers
  std::int64_t still_steps_ = 0;
  bool crowded_ = false;
  bool acted_ = false;
  bool telling_ = false;  // the last action was one that should have moved the needle
  geometry::Vector2 last_position_m_ = geometry::Vector2::Zero();
};

}  // namespace lodestone::control
