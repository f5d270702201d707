#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/control/controller.h"

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
  double steering = 1.0;
  std::int64_t stuck_steps = 4;
  double stuck_threshold_m = 0.0015;
  double crowding = 1.5;

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("dish_radius_m", "rig.dish.radius_m");
    v.retired("start_radius_m", "start_radius, in dish radii");
    v.field("start_radius", start_radius, "dish radii", "the operator places the needle within this radius",
            {0.0, 1.0});
    v.field("cell_m", cell_m, "m", "side of a cell of the visit counts", {1e-4, 1.0});
    v.field("heading_bins", heading_bins, "", "heading bins of the visit counts", {1, 360});
    v.field("level_bins", level_bins, "", "current levels per axis and sign of the visit counts", {1, 100});
    v.field("candidates", candidates, "", "random actions the least visited is chosen from", {1, 10000});
    v.field("single_axis_fraction", single_axis_fraction, "",
            "fraction of candidates that drive one axis only", {0.0, 1.0});
    v.retired("single_axis_share", "single_axis_fraction");
    v.retired("zero_share", "zero_fraction");
    v.field("zero_fraction", zero_fraction, "", "fraction of steps without current", {0.0, 1.0});
    v.field("min_drive", min_drive, "", "smallest axis drive, as a fraction of the largest current",
            {0.0, 1.0});
    v.field("steering", steering, "", "weight of steering towards places seldom visited; 0 is off",
            {0.0, 100.0});
    v.field("stuck_steps", stuck_steps, "", "steps without motion after which the operator moves the needle",
            {1, 1000});
    v.field("crowding", crowding, "",
            "where visits exceed the mean by this factor, one step without motion calls the operator",
            {0.0, 1e6});
    v.field("stuck_threshold_m", stuck_threshold_m, "m", "a sensed step shorter than this is no motion",
            {0.0, 0.1});
  }
};

/// Guided exploration as a careful operator would do it: counts visits per position, heading and current,
/// remembers where currents took the needle from each place, and of some random actions takes the one tried
/// least here that leads to places seldom visited. Uses sensed poses only. The target of an observation is
/// ignored.
class Explorer final : public Controller {
 public:
  Explorer(const ExplorerConfig& config, double dish_radius_m, common::RandomStream random);

  void reset() override;
  geometry::Vector2 act(const task::Observation& observation) override;

  /// Where the operator puts the needle for the next episode: the least visited of some random places, any
  /// heading.
  /// `fits` says whether the needle would lie inside the dish wall, which an operator sees.
  geometry::Pose2 next_start(const std::function<bool(const geometry::Pose2&)>& fits);
  /// True when the needle has not moved for `stuck_steps` steps, or not at all in a crowded place such as the
  /// wall before a coil: time for the operator.
  bool stuck() const { return still_steps_ >= (crowded_ ? 1 : config_.stuck_steps); }

  /// Counts and random state, for bitwise resumption.
  common::Json save() const;
  void restore(const common::Json& state);

 private:
  geometry::Vector2 draw_action();
  std::int64_t cell_of(const geometry::Vector2& position_m) const;
  std::int64_t heading_of(double heading_rad) const;
  std::int64_t level_of(const geometry::Vector2& action) const;
  double cost(const geometry::Pose2& pose, const geometry::Vector2& action) const;
  double mean_visits() const;

  ExplorerConfig config_;
  double dish_radius_m_;
  common::RandomStream random_;
  std::int64_t side_ = 0;                        // cells along a side of the grid
  std::int64_t levels_ = 0;                      // bins of one axis drive, signs and zero included
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
  geometry::Vector2 last_position_m_ = geometry::Vector2::Zero();
};

}  // namespace lodestone::control
