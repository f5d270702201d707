#include "lodestone/safety/keep_out_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "lodestone/geometry/angle.h"

namespace lodestone::safety {

void KeepOutCheck::observe(const control::PoseEstimate& estimate, double) {
  const std::lock_guard<std::mutex> lock(mutex_);
  put_together(/*anew=*/true);
  // With the 2 sigma by which its middle may lie nearer, and those by which its ends may.
  const double turn_rad = std::min(2.0 * estimate.heading_sigma_rad, 0.5 * geometry::kPi);
  const double unsure_m = 2.0 * estimate.position_sigma_m + 0.5 * keep_out_.needle_length_m * turn_rad;
  for (const geometry::Zone& zone : keep_out_.zones) {
    const double clearance_m = keep_out_.clearance_m(estimate.pose, zone) - unsure_m;
    if (!(clearance_m > keep_out_.margin_m))
      throw Distrust(
          fmt::format("the needle may lie {:g} mm from the keep-out zone {}, within the margin of {:g} mm "
                      "(safety.keep_out, safety.keep_out_margin_m)",
                      1e3 * clearance_m, zone.called(), 1e3 * keep_out_.margin_m));
  }
}

void KeepOutCheck::put_together(bool anew) {
  try {
    if (anew) moving_ = file_.zones();
  } catch (const common::ConfigError& error) {
    throw Distrust(error.what());
  }
  keep_out_.zones = zones_;
  keep_out_.zones.insert(keep_out_.zones.end(), moving_.begin(), moving_.end());
}

void KeepOutCheck::look() {
  const std::lock_guard<std::mutex> lock(mutex_);
  put_together(/*anew=*/true);
}

void KeepOutCheck::move_zones(std::vector<geometry::Zone> zones) {
  const std::lock_guard<std::mutex> lock(mutex_);
  zones_ = std::move(zones);
}

std::vector<geometry::Zone> KeepOutCheck::zones() {
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    put_together(/*anew=*/true);
  } catch (const Distrust&) {
    put_together(/*anew=*/false);
  }
  return keep_out_.zones;
}

}  // namespace lodestone::safety
