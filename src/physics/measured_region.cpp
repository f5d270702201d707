#include "lodestone/physics/measured_region.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/physics/solid_harmonics.h"

namespace lodestone::physics {
namespace {

constexpr int kLimitDegree = 20;

int degree_of(std::size_t numbers) {
  return static_cast<int>(std::lround(std::sqrt(static_cast<double>(numbers) + 1.0))) - 1;
}

}  // namespace

bool are_harmonics(std::size_t numbers) {
  const int degree = degree_of(numbers);
  return degree >= 1 && degree <= kLimitDegree && static_cast<std::size_t>(harmonic_count(degree)) == numbers;
}

void MeasuredRegion::validate() const {
  const auto need = [](const char* key, const std::vector<double>& list, std::size_t count) {
    if (list.size() == count) return;
    if (count == 0)
      throw common::InvalidConfig(key, list, "be [] as centre_m is, which says that no coil was measured");
    throw common::InvalidConfig(key, list, "hold [x, y, z]");
  };
  if (!empty()) need("centre_m", centre_m, 3);
  need("low_m", low_m, centre_m.size());
  need("high_m", high_m, centre_m.size());
  for (std::size_t axis = 0; axis < centre_m.size(); ++axis)
    if (!(low_m[axis] < high_m[axis]))
      throw common::InvalidConfig("low_m", low_m, "be below high_m along x, y and z");
  if (background_T.empty()) return;
  if (empty()) need("background_T", background_T, 0);
  if (!are_harmonics(background_T.size()))
    throw common::InvalidConfig("background_T", background_T.size(),
                                "be 3, 8, 15, 24, ... numbers: harmonics of degree 1, 2, 3, 4, ...");
}

Eigen::Vector3d MeasuredRegion::sum(const std::vector<double>& harmonics,
                                    const Eigen::Vector3d& point_m) const {
  if (harmonics.empty()) return Eigen::Vector3d::Zero();
  LODESTONE_CHECK(!empty() && are_harmonics(harmonics.size()), "harmonics, and what they are about");
  const Eigen::Vector3d centre(centre_m[0], centre_m[1], centre_m[2]);
  const HarmonicGradients gradients =
      harmonic_gradients(degree_of(harmonics.size()), (point_m - centre) / scale_m);
  return gradients * Eigen::Map<const Eigen::VectorXd>(harmonics.data(), gradients.cols());
}

void MeasuredRegion::check_holds(const Eigen::Vector3d& point_m) const {
  for (std::size_t axis = 0; axis < centre_m.size(); ++axis) {
    const double at_m = point_m[static_cast<Eigen::Index>(axis)];
    if (!(at_m >= low_m[axis] && at_m <= high_m[axis]))
      throw common::DataError(fmt::format(
          "the field at ({:.1f}, {:.1f}, {:.1f}) mm is not known: {} was measured from {:.1f} to {:.1f} mm",
          1e3 * point_m.x(), 1e3 * point_m.y(), 1e3 * point_m.z(), "xyz"[axis], 1e3 * low_m[axis],
          1e3 * high_m[axis]));
  }
}

double MeasuredRegion::disc_radius_m() const {
  if (empty() || low_m[2] > 0.0 || high_m[2] < 0.0) return 0.0;
  return std::max(0.0, std::min({-low_m[0], high_m[0], -low_m[1], high_m[1]}));
}

}  // namespace lodestone::physics
