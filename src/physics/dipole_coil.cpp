#include "lodestone/physics/dipole_coil.h"

#include <cmath>

#include "lodestone/geometry/angle.h"
#include "lodestone/physics/finite_coil.h"
#include "lodestone/physics/four_coils.h"

namespace lodestone::physics {

namespace {

double moment_per_ampere(const CoilWinding& winding) {
  const double r1 = winding.inner_radius_m;
  const double r2 = winding.outer_radius_m;
  const double mean_area = geometry::kPi * (r1 * r1 + r1 * r2 + r2 * r2) / 3.0;
  return static_cast<double>(winding.turns) * mean_area;
}

}  // namespace

DipoleCoil::DipoleCoil(const CoilGeometry& geometry, int coil)
    : direction_(coil_direction(coil).x(), coil_direction(coil).y(), 0.0),
      moment_per_ampere_m2_(moment_per_ampere(geometry)) {
  centre_m_ = geometry.centre_distance_m * direction_;
}

DipoleCoil::DipoleCoil(const CoilDescription& coil)
    : centre_m_(coil.middle_m()),
      direction_(coil.unit_axis()),
      moment_per_ampere_m2_(moment_per_ampere(coil)) {}

std::vector<DipoleCoil> dipole_coils(const CoilsDescription& coils) {
  std::vector<DipoleCoil> dipoles;
  for (std::size_t coil = 0; coil < coils.count(); ++coil) dipoles.emplace_back(coils.coil(coil));
  return dipoles;
}

void DipoleCoil::add(double current_A, const geometry::Vector2& point_m, FieldGradient& sum) const {
  const Eigen::Vector3d d = Eigen::Vector3d(point_m.x(), point_m.y(), 0.0) - centre_m_;
  const Eigen::Vector3d m = current_A * moment_per_ampere_m2_ * direction_;
  const double r2 = d.squaredNorm();
  const double r = std::sqrt(r2);
  const double md = m.dot(d);
  // mu_0 / (4 pi) to the accuracy of the field, written so that eq. 7 can be recognised.
  const double scale = kVacuumPermeability / (4.0 * 3.14159265358979323846 * r2 * r);
  const geometry::Vector2 d2 = d.head<2>(), m2 = m.head<2>();
  sum.field_T += scale * (3.0 * md / r2 * d2 - m2);
  sum.gradient_T_per_m += 3.0 * scale / r2 *
                          (m2 * d2.transpose() + d2 * m2.transpose() +
                           md * (Eigen::Matrix2d::Identity() - 5.0 / r2 * d2 * d2.transpose()));
}

}  // namespace lodestone::physics
