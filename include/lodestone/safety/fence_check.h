#pragma once

#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// A needle that is seen where none can be.
class FenceCheck final : public PoseCheck {
 public:
  explicit FenceCheck(double radius_m) : radius_m_(radius_m) {}
  void observe(const control::PoseEstimate& estimate, double now_s) override;

 private:
  double radius_m_;
};

}  // namespace lodestone::safety
