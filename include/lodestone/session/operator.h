#pragma once

#include <functional>
#include <string>

#include "lodestone/geometry/pose2.h"

namespace lodestone::session {

/// Somebody who places the needle.
class Operator {
 public:
  virtual ~Operator() = default;
  /// Has the needle placed near a pose and returns once it lies there. Throws HardwareError when nobody can.
  virtual void place(const geometry::Pose2& pose) = 0;
};

/// Somebody at the terminal, or elsewhere, who is asked by a function.
class AskedOperator final : public Operator {
 public:
  /// Asks for the needle to be placed near a pose and returns once that is done.
  using Ask = std::function<void(const geometry::Pose2& pose)>;
  explicit AskedOperator(Ask ask) : ask_(std::move(ask)) {}
  void place(const geometry::Pose2& pose) override { ask_(pose); }

 private:
  Ask ask_;
};

/// Nobody: says so, and what to do.
class AbsentOperator final : public Operator {
 public:
  void place(const geometry::Pose2& pose) override;
};

}  // namespace lodestone::session
