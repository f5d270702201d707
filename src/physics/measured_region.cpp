#include "lodestone/physics/measured_field.h"

#include <fmt/core.h>

#include "lodestone/common/error.h"
#include "lodestone/physics/solid_harmonics.h"

namespace lodestone::physics {
namespace {

constexpr std::int64_t kLimitDegree = 20;

}  // namespace

void MeasuredField::validate() const {
  if (degree < 1 || degree > kLimitDegree)
    throw common::DataError(fmt::format("degree = {} must be within 1 and {}", degree, kLimitDegree));
  const auto count = static_cast<std::size_t>(harmonic_count(static_cast<int>(degree)));
  if (background_T.size() != count)
    throw common::DataError(
        fmt::format("background_T must hold {} numbers, not {}", count, background_T.size()));
  if (coils_T_per_A.empty()) throw common::DataError("coils_T_per_A must hold a coil at least");
  for (const std::vector<double>& coil : coils_T_per_A)
    if (coil.size() != count)
      throw common::DataError(
          fmt::format("each of coils_T_per_A must hold {} numbers, not {}", count, coil.size()));
  if (!(scale_m > 0.0)) throw common::DataError("scale_m must be above 0");
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(low_m[axis] < high_m[axis])) throw common::DataError("low_m must be below high_m");
}

Eigen::Vector3d MeasuredField::field_T(const Eigen::VectorXd& current_A,
                                       const Eigen::Vector3d& point_m) const {
  LODESTONE_CHECK(current_A.size() == static_cast<Eigen::Index>(coils_T_per_A.size()),
                  "a current for each coil");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at_m = point_m[static_cast<Eigen::Index>(axis)];
    if (!(at_m >= low_m[axis] && at_m <= high_m[axis]))
      throw common::DataError(fmt::format(
          "the field at ({:.1f}, {:.1f}, {:.1f}) mm is not known: {} was measured from {:.1f} to {:.1f} mm",
          1e3 * point_m.x(), 1e3 * point_m.y(), 1e3 * point_m.z(), "xyz"[axis], 1e3 * low_m[axis],
          1e3 * high_m[axis]));
  }
  const Eigen::Vector3d centre(centre_m[0], centre_m[1], centre_m[2]);
  const HarmonicGradients gradients =
      harmonic_gradients(static_cast<int>(degree), (point_m - centre) / scale_m);
  Eigen::VectorXd sum = Eigen::Map<const Eigen::VectorXd>(background_T.data(), gradients.cols());
  for (std::size_t coil = 0; coil < coils_T_per_A.size(); ++coil)
    sum += current_A[static_cast<Eigen::Index>(coil)] *
           Eigen::Map<const Eigen::VectorXd>(coils_T_per_A[coil].data(), gradients.cols());
  return gradients * sum;
}

}  // namespace lodestone::physics
