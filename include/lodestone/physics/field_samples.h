#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace lodestone::physics {

/// What a magnetometer saw: places (m), the currents of all coils (A) and the field (T).
struct FieldSamples {
  std::size_t coils = 0;
  std::vector<Eigen::Vector3d> position_m;
  std::vector<Eigen::VectorXd> current_A;  ///< [coils] each
  std::vector<Eigen::Vector3d> field_T;

  std::size_t size() const { return position_m.size(); }
};

/// Reads a CSV file with the columns x, y, z and Bx, By, Bz, each with its unit (x_m or x_mm; Bx_T, Bx_mT or
/// Bx_uT), and current_1_A, current_2_A, ... (or I_1_A, ...). Throws IoError, and DataError naming line and
/// column: a column without a unit, a number out of every reason, a coil that was never on, or coils whose
/// currents always go together.
FieldSamples read_field_samples(const std::string& path);

}  // namespace lodestone::physics
