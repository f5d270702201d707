#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "lodestone/session/ground_truth.h"

namespace lodestone::tests {

/// What every GroundTruth must do: tell a pose, and go on after load() as if nothing had happened since
/// save(). `drive` makes something happen.
inline void check_ground_truth(session::GroundTruth& truth, const std::function<void()>& drive) {
  drive();
  const common::Json saved = truth.save();
  const geometry::Pose2 before = truth.true_pose();
  CHECK(std::isfinite(before.x_m));
  CHECK(std::isfinite(before.heading_rad));
  drive();
  const common::Json first = truth.save();
  CHECK(first != saved);
  truth.load(saved);
  CHECK(truth.save() == saved);
  CHECK(truth.true_pose().x_m == before.x_m);
  drive();
  CHECK(truth.save() == first);
}

/// A needle that every drive moves by a millimetre.
class FakeGroundTruth final : public session::GroundTruth {
 public:
  geometry::Pose2 true_pose() const override { return {1e-3 * steps, 0.0, 0.0}; }
  common::Json save() const override { return steps; }
  void load(const common::Json& state) override { steps = state.get<int>(); }
  int steps = 0;
};

}  // namespace lodestone::tests
