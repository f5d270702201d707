#pragma once

#include <catch2/catch.hpp>
#include <functional>

#include "lodestone/session/operator.h"

namespace lodestone::tests {

/// What every Operator must do: when place() has returned, the needle lies about there, however often.
inline void check_operator(session::Operator& needle_operator,
                           const std::function<geometry::Pose2()>& lies_at, double within_m) {
  for (const geometry::Pose2& pose : {geometry::Pose2{0.01, 0.0, 1.0}, geometry::Pose2{-0.005, 0.02, -2.0},
                                      geometry::Pose2{-0.005, 0.02, -2.0}}) {
    needle_operator.place(pose);
    CHECK((lies_at().position_m() - pose.position_m()).norm() <= within_m);
  }
}

/// An operator who remembers.
class FakeOperator final : public session::Operator {
 public:
  void place(const geometry::Pose2& pose) override {
    placed = pose;
    ++count;
    if (at_work) at_work();
  }
  geometry::Pose2 placed;
  int count = 0;
  std::function<void()> at_work;
};

}  // namespace lodestone::tests
