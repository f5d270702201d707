#pragma once

#include <optional>

#include "lodestone/common/random.h"
#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/rl/imagined_task.h"
#include "lodestone/task/observation.h"

namespace lodestone::rl {

/// How rigs differ that learners imagine, and how often and how near their needles are sent elsewhere.
struct ImaginationConfig {
  double gain_sigma = 0.45;
  double least_gain_sigma = 0.03;
  double place_sigma = 0.1;
  double place_size_m = 0.002;
  double new_goal = 0.1;
  double near_goals = 0.5;
  double most_target_step_m = 0.001;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("gain_sigma", gain_sigma, "",
            "standard deviation of the logarithm of the drive's gain over the rigs that are imagined",
            {0.0, 2.0});
    v.field(
        "least_gain_sigma", least_gain_sigma, "",
        "what is left of it once a rig is known: estimates lie between the two, spread by their logarithm",
        {0.0, 2.0});
    v.field("place_sigma", place_sigma, "",
            "the same of a place's own part: friction that stays the same until the needle is elsewhere",
            {0.0, 2.0});
    v.field("place_size_m", place_size_m, "m", "how far elsewhere is", {0.0, 1.0});
    v.field("new_goal", new_goal, "", "chance of a new goal at every pulse", {0.0, 1.0});
    v.field(
        "near_goals", near_goals, "",
        "share of the goals that lie near, at distances spread by their logarithm; the others all over the "
        "disc",
        {0.0, 1.0});
    v.field("most_target_step_m", most_target_step_m, "m/pulse", "goals that move do so by up to this",
            {0.0, 0.1});
  }
};

/// A needle on an imagined rig, which a learner steps in the learned simulator: its rig answers by a gain of
/// its own, of which an estimate is told, as identification tells one, and places hold the needle more or
/// less.
struct ImaginedNeedle {
  geometry::Pose2 pose;
  task::DriveGain told;
  double log_gain = 0.0;   ///< of the rig
  double log_place = 0.0;  ///< and of the place: friction that stays with it
  geometry::Vector2 place_m = geometry::Vector2::Zero();
  geometry::Drive last_action = geometry::Drive::Zero(2);
  geometry::Vector2 last_displacement_m = geometry::Vector2::Zero();

  /// On the drive.
  double factor() const;
  /// Somewhere else, where nothing has happened yet.
  void put(const geometry::Pose2& there, const ImaginationConfig& config, common::RandomStream& random);
  /// Another rig: an estimate, and the truth as far from it as the estimate says, as with a filter's
  /// posterior.
  void draw_rig(const ImaginationConfig& config, common::RandomStream& random);
  /// Notes the pulse that has brought it from `before_m` to where it is.
  void note_pulse(const geometry::Drive& action, const geometry::Vector2& before_m,
                  const ImaginationConfig& config, common::RandomStream& random);
};

/// A place near another, at a distance that is spread by its logarithm; nothing where goals may not lie
/// there.
std::optional<geometry::Vector2> draw_near_m(const geometry::Vector2& place_m, const ImaginedTask& task,
                                             common::RandomStream& random);

/// Between the two, spread by the logarithm.
double draw_log_uniform(double least, double most, common::RandomStream& random);

}  // namespace lodestone::rl
