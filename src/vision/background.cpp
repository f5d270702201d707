#include "lodestone/vision/background.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::vision {

namespace {

constexpr double kAlike_m = 1e-3;
constexpr double kAlike_rad = 10.0 * geometry::kRadPerDeg;
constexpr double kNear_m = 10e-3;  // a weak pulse takes no needle further
constexpr std::size_t kMostThings = 32;

double distance_m(const Rod& a, const Rod& b) { return (a.pose.position_m() - b.pose.position_m()).norm(); }

}  // namespace

bool lies_alike(const Rod& a, const Rod& b) {
  return distance_m(a, b) <= kAlike_m &&
         std::abs(std::cos(a.pose.heading_rad - b.pose.heading_rad)) >= std::cos(kAlike_rad);
}

void Background::pulse() {
  for (Thing& thing : things_) ++thing.pulses;
}

void Background::pulse_cut() {
  for (Thing& thing : things_) thing.pulses = std::max(0, thing.pulses - 1);
}

void Background::see(const std::vector<Rod>& candidates) {
  for (const Rod& rod : candidates) {
    const auto known = std::find_if(things_.begin(), things_.end(),
                                    [&](const Thing& thing) { return lies_alike(thing.rod, rod); });
    if (known != things_.end())
      known->still = known->still || known->pulses > 0;
    else
      things_.push_back({rod});
  }
  if (things_.size() > kMostThings) things_.erase(things_.begin(), things_.end() - kMostThings);
}

void Background::except(const Rod& needle) {
  things_.erase(std::remove_if(things_.begin(), things_.end(),
                               [&](const Thing& thing) { return lies_alike(thing.rod, needle); }),
                things_.end());
}

bool Background::holds(const Rod& rod) const {
  return std::any_of(things_.begin(), things_.end(),
                     [&](const Thing& thing) { return thing.still && lies_alike(thing.rod, rod); });
}

bool Background::has_stirred(const Rod& rod) const {
  bool near = false;
  for (const Thing& thing : things_) {
    if (thing.pulses == 0) continue;
    if (lies_alike(thing.rod, rod)) return false;
    near = near || distance_m(thing.rod, rod) <= kNear_m;
  }
  return near;
}

}  // namespace lodestone::vision
