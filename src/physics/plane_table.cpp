#include "lodestone/physics/plane_table.h"

#include <cmath>
#include <string>

#include "cubic_spline.h"
#include "lodestone/common/error.h"

namespace lodestone::physics {

PlaneTable::PlaneTable(const std::function<Eigen::Vector3d(const geometry::Vector2&)>& field, double reach_m,
                       double spacing_m)
    : reach_m_(reach_m), spacing_m_(spacing_m) {
  LODESTONE_CHECK(reach_m > 0.0 && spacing_m > 0.0, "reach and spacing must be positive");
  const int half = static_cast<int>(std::ceil(reach_m / spacing_m - 1e-9)) + kSplinePadding;
  side_ = 2 * half + 1;
  origin_m_ = -half * spacing_m;
  coefficients_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) * 3);
  const auto at = [&](int i, int j) {
    return &coefficients_[(static_cast<std::size_t>(i) * static_cast<std::size_t>(side_) +
                           static_cast<std::size_t>(j)) *
                          3];
  };
  for (int i = 0; i < side_; ++i)
    for (int j = 0; j < side_; ++j)
      Eigen::Map<Eigen::Vector3d>(at(i, j)) = field({origin_m_ + i * spacing_m, origin_m_ + j * spacing_m});
  std::vector<double> scratch;
  for (int component = 0; component < 3; ++component) {
    for (int i = 0; i < side_; ++i) to_spline(at(i, 0) + component, side_, 3, scratch);
    for (int j = 0; j < side_; ++j) to_spline(at(0, j) + component, side_, 3 * side_, scratch);
  }
}

Eigen::Vector3d PlaneTable::at(const geometry::Vector2& point_m) const {
  LODESTONE_CHECK(std::abs(point_m.x()) <= reach_m_ && std::abs(point_m.y()) <= reach_m_,
                  "point (" + std::to_string(point_m.x()) + ", " + std::to_string(point_m.y()) +
                      ") m outside the field table");
  const double u = (point_m.x() - origin_m_) / spacing_m_;
  const double v = (point_m.y() - origin_m_) / spacing_m_;
  const int i = static_cast<int>(u);
  const int j = static_cast<int>(v);
  const SplineWeights wu = spline_weights(u - i);
  const SplineWeights wv = spline_weights(v - j);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int p = 0; p < 4; ++p) {
    const double* row =
        &coefficients_[(static_cast<std::size_t>(i - 1 + p) * static_cast<std::size_t>(side_) +
                        static_cast<std::size_t>(j - 1)) *
                       3];
    for (int q = 0; q < 4; ++q) sum += wu.w[p] * wv.w[q] * Eigen::Map<const Eigen::Vector3d>(row + 3 * q);
  }
  return sum;
}

}  // namespace lodestone::physics
