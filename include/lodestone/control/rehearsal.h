#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lodestone/control/controller.h"
#include "lodestone/control/foresight.h"
#include "lodestone/control/suture_reference.h"
#include "lodestone/geometry/stitch.h"

namespace lodestone::control {

/// A controller, and the learned simulator in which it rehearses.
struct Rehearsal {
  Controller& controller;
  task::ActionConfig action;  ///< the controller's, in A
  Foresight& foresight;       ///< of states with a heading
  double drive_per_A = 1.0;   ///< takes amperes to its unit of drive
  double period_s = 0.0;      ///< of the control loop
};

/// How far beside the ends of a stitch a needle passes, to the left of the heading there.
struct Passed {
  double entry_m = 0.0;
  double exit_m = 0.0;
};

/// Pushes a needle through a stitch in the simulator, from where it is waited for, and tells how it passed;
/// nothing where it never came past both ends. `index` tells rehearsals apart: each has its own luck, and the
/// next member of the ensemble.
std::optional<Passed> rehearse(const geometry::Stitch& stitch, const SutureReferenceConfig& config,
                               const Rehearsal& with, std::uint64_t seed, std::uint64_t index);

/// Where to lead the needle so that it passes both ends of every stitch: the force on a needle and the field
/// that it lies along differ in direction, so that a needle that is pushed along its heading drifts aside, as
/// far each time. Its way, as the rehearsals have it in the mean, is moved aside so that it is as far from
/// the entry as from the exit, at most config.aside_m. A stitch stays as it is, and that is logged, where a
/// rehearsal never came through it. Throws common::LogicFault where the simulator knows no headings, and
/// common::Interrupted.
std::vector<geometry::Stitch> rehearsed(const std::vector<geometry::Stitch>& stitches,
                                        const SutureReferenceConfig& config, const Rehearsal& with,
                                        std::uint64_t seed);

}  // namespace lodestone::control
