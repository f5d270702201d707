#include "lodestone/physics/dipole_coil.h"

#include <cmath>

#include "lodestone/geometry/angle.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/finite_coil.h"

namespace lodestone::physics {

DipoleCoil::DipoleCoil(const CoilGeometry& geometry, int coil)
    : centre_m_(geometry.centre_distance_m * coil_direction(coil)), direction_(coil_direction(coil)) {
  const double r1 = geometry.inner_radius_m;
  const double r2 = geometry.outer_radius_m;
  const double mean_area = geometry::kPi * (r1 * r1 + r1 * r2 + r2 * r2) / 3.0;
  moment_per_ampere_m2_ = static_cast<double>(geometry.turns) * mean_area;
}

void DipoleCoil::add(double current_A, const geometry::Vector2& point_m, FieldGradient& sum) const {
  const geometry::Vector2 d = point_m - centre_m_;
  const geometry::Vector2 m = current_A * moment_per_ampere_m2_ * direction_;
  const double r2 = d.squaredNorm();
  const double r = std::sqrt(r2);
  const double md = m.dot(d);
  // mu_0 / (4 pi) to the accuracy of the field, written so that eq. 7 can be recognised.
  const double scale = kVacuumPermeability / (4.0 * 3.14159265358979323846 * r2 * r);
  sum.field_T += scale * (3.0 * md / r2 * d - m);
  sum.gradient_T_per_m += 3.0 * scale / r2 *
                          (m * d.transpose() + d * m.transpose() +
                           md * (Eigen::Matrix2d::Identity() - 5.0 / r2 * d * d.transpose()));
}

}  // namespace lodestone::physics
