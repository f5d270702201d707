#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "lodestone/experiments/qualification_statistics.h"
#include "lodestone/runs/qualification_result.h"

namespace lodestone::experiments {

/// One of the weak pulses that are given at several places, ever stronger ones: level by level, the first
/// level of every place as strong against the pull that should break the needle loose there.
struct WeakPulse {
  std::size_t place = 0;
  std::size_t level = 0;
  double current_A = 0.0;           ///< of the drive
  std::optional<std::size_t> coil;  ///< where only one is on
  double drive_rad = 0.0;           ///< where the drive points
  PulseMotion motion;
  bool moved = false;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("place", place);
    v.field("level", level);
    v.field("current_A", current_A);
    v.field("coil", coil);
    v.field("drive_rad", drive_rad);
    motion.visit(v);
    v.field("moved", moved);
  }
};

/// The current at which half of the pulses move the needle, between the levels by its logarithm; the lowest
/// one where they do so from the start on. Nothing where they never do.
std::optional<double> breakaway_A(const std::vector<WeakPulse>& pulses);

/// What pulses of each level do, in the frame of their drive, explained by the heading before: what a
/// controller can know. `sensing_m`: spread of a sensed position per axis, whose part is taken off the
/// scatter. Levels of fewer than six pulses are left out.
std::vector<runs::StepLevel> step_levels(const std::vector<WeakPulse>& pulses, double sensing_m);

/// All of it, place by place. Nothing without pulses.
std::optional<runs::StickSlipFigures> stick_slip_figures(const std::vector<WeakPulse>& pulses,
                                                         double sensing_m);

/// How strongly the needle answers to each coil, beside the mean coil: by the currents that move it at one
/// place. Absent for a coil that alone never moved it.
std::vector<std::optional<runs::Measured>> gains_by_motion(const std::vector<WeakPulse>& pulses,
                                                           std::size_t place, std::size_t coils);

}  // namespace lodestone::experiments
