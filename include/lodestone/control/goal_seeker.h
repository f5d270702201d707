#pragma once

#include <cstdint>
#include <memory>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/control/controller.h"

namespace lodestone::control {

/// How a rig is explored with a controller that already knows something.
struct GoalSeekerConfig {
  double goal_radius = 0.7;
  double reached_m = 0.0015;
  std::int64_t max_pulses_per_target = 12;
  double noise = 0.1;
  double weak_fraction = 0.0;
  double weakest_drive = 0.0133;
  std::int64_t stuck_pulses = 20;
  double stuck_threshold_m = 0.0005;

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("goal_radius_m", "goal_radius, in dish radii");
    v.field("goal_radius", goal_radius, "dish radii", "targets are drawn over a disc of this radius",
            {0.0, 1.0});
    v.field("reached_m", reached_m, "m", "a target sensed closer than this is followed by the next one",
            {0.0, 0.1});
    v.field("max_pulses_per_target", max_pulses_per_target, "pulses", "or after so many", {1, 100000});
    v.retired("patience", "max_pulses_per_target");
    v.field("noise", noise, "action units", "standard deviation of what is added to every action",
            {0.0, 2.0});
    v.field(
        "weak_fraction", weak_fraction, "",
        "fraction of pulses that are weak ones in any direction instead, which turn the needle where it lies",
        {0.0, 1.0});
    v.field("weakest_drive", weakest_drive, "",
            "their largest number is log-uniform from this fraction of the largest current to all of it",
            {1e-4, 0.9});
    v.field("stuck_pulses", stuck_pulses, "pulses",
            "so many in a row that do not move the needle, and the operator is asked to place it",
            {1, 100000});
    v.field("stuck_threshold_m", stuck_threshold_m, "m", "a sensed step shorter than this is no motion",
            {0.0, 0.1});
  }
};

/// Sends a controller from target to target, with some noise on its actions, and weak pulses among them where
/// that is asked for: the second round of collection, which records what the policy will meet.
class GoalSeeker final : public Controller {
 public:
  GoalSeeker(std::unique_ptr<Controller> inner, const GoalSeekerConfig& config, double dish_radius_m,
             common::RandomStream random);

  void reset() override;
  /// The observation's own target is replaced by the seeker's.
  geometry::Drive act(const task::Observation& observation) override;

  /// The controller does not get the needle to move, until the next reset().
  bool stuck() const { return still_pulses_ >= config_.stuck_pulses; }

  /// The state between two episodes, and back. restore() throws DataError.
  std::string save() const;
  void restore(const std::string& state);

 private:
  void draw_target();

  std::unique_ptr<Controller> inner_;
  GoalSeekerConfig config_;
  double dish_radius_m_;
  common::RandomStream random_;
  geometry::Vector2 target_m_ = geometry::Vector2::Zero();
  std::int64_t steps_ = 0;
  std::int64_t still_pulses_ = 0;
  bool weak_ = false;  // the last pulse was a weak one: that the needle has not moved tells nothing
};

}  // namespace lodestone::control
