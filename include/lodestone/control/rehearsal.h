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
/// nothing where it never came past the exit. `turn` tells rehearsals apart: each has its own luck, and the
/// next member of the ensemble.
std::optional<Passed> rehearse(const geometry::Stitch& stitch, const SutureReferenceConfig& config,
                               const Rehearsal& with, std::uint64_t seed, std::uint64_t turn);

/// Where to lead the needle so that it passes both ends of every stitch: force and field of a coil differ in
/// direction, so that a needle that is pushed along its heading drifts aside, as far each time. Half of that,
/// as the rehearsals have it in the mean, is made up for beforehand at the entry, half is left at the exit:
/// one step of iterative learning control (Arimoto, Kawamura and Miyazaki, 1984), in the simulator. A stitch
/// stays as it is where some rehearsal never came past its exit. Throws common::LogicFault where the
/// simulator knows no headings.
std::vector<geometry::Stitch> rehearsed(const std::vector<geometry::Stitch>& stitches,
                                        const SutureReferenceConfig& config, const Rehearsal& with,
                                        std::uint64_t seed);

}  // namespace lodestone::control
