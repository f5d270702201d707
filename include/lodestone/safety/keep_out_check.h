#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "lodestone/geometry/keep_out.h"
#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// A needle that may lie within the margin of a zone that it must keep out of.
class KeepOutCheck final : public PoseCheck {
 public:
  explicit KeepOutCheck(geometry::KeepOut keep_out) : keep_out_(std::move(keep_out)) {}
  void observe(const control::PoseEstimate& estimate, double now_s) override;

  /// From any thread: from the next pose on it is these zones.
  void move_zones(std::vector<geometry::Zone> zones);

 private:
  std::mutex mutex_;  // of the zones
  geometry::KeepOut keep_out_;
};

}  // namespace lodestone::safety
