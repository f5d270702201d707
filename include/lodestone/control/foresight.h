#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "lodestone/common/random.h"
#include "lodestone/task/action.h"

namespace lodestone::control {

/// What a planner plans in: tells where pulses would take the needle.
class Foresight {
 public:
  struct Facts {
    task::ActionConfig action;   ///< in its own unit of drive
    std::size_t state_size = 3;  ///< S: x_m, y_m and, but for a sphere, heading_rad
    double dish_radius_m = 0.0;
    std::size_t ways = 1;    ///< in which outcomes may differ beside by luck: the members of an ensemble
    bool by_chance = false;  ///< the same pulse may end otherwise
  };

  virtual ~Foresight() = default;
  virtual const Facts& facts() const = 0;
  /// For particle after particle of a plan: `state` [rows, S] after pulses with `drive` [rows, A] that begin
  /// `periods` periods of the control loop from now, in one way and with the same luck for all rows. Writes
  /// `next` [rows, S].
  virtual void foresee(std::size_t way, std::size_t periods, const double* state, const double* drive,
                       std::int64_t rows, common::RandomStream& random, double* next) = 0;
  /// One of its own, for another thread.
  virtual std::shared_ptr<Foresight> clone() const = 0;
};

}  // namespace lodestone::control
