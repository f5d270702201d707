#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/apart_coils.h"
#include "lodestone/physics/coil_fields.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::physics {

/// What every coil gets for a field and a pull on the needle (DriveKind::kField), wherever that is: of all
/// currents within the coils' limits those whose field and pull come nearest, by bounded least squares, and
/// of equal ones the smallest. Where both are along one direction, found once for 120 directions at places
/// over the dish, and interpolated between them. Immutable: rigs share one.
class FieldAllocation {
 public:
  /// Everywhere the same field and pull are asked for: the largest pull that every direction can have at the
  /// dish centre. Where both at once are out of reach, as with four unipolar coils between their axes, each
  /// as nearly as it can. Throws ConfigError where they would be more than 25 degrees off at the centre,
  /// unless the coils are driven one by one (DriveKind::kIndependent): then as nearly as they can.
  explicit FieldAllocation(const RigDescription& rig);

  /// As constructed, or that of an equal rig which somebody still holds. From any thread.
  static std::shared_ptr<const FieldAllocation> shared(const RigDescription& rig);

  /// Currents (A) of a full drive along a direction, for a needle at a point of the dish frame; of those
  /// outside the dish, as at its wall.
  PerCoil current_A(double direction_rad, const geometry::Vector2& position_m) const;
  /// Currents (A) of a field and a pull of their own, each as a share of what a full drive asks for, on a
  /// needle that lies along the field; along the pull where no field is asked for.
  PerCoil current_A(const geometry::Vector2& field_share, const geometry::Vector2& pull_share,
                    const geometry::Vector2& position_m) const;
  /// What a full drive pulls at the dish centre, per A m2 of a needle that lies along it (T/m).
  double pull_T_per_m() const { return pull_T_per_m_; }

 private:
  void add(double share, std::size_t node, double place, PerCoil& sum_A) const;

  std::size_t coils_ = 0;
  CoilsDescription description_;
  std::shared_ptr<const CoilFields> fields_;
  double chain_m_ = 0.0;
  double half_side_m_ = 0.0;
  std::vector<double> current_A_;  ///< [place along y][along x][direction][coil]
  ApartCoils apart_;
  double strongest_T_ = 0.0;  ///< of one coil alone at the dish centre, and
  double steepest_T_per_m_ = 0.0;
  double field_T_ = 0.0;  ///< what a full drive asks for
  double pull_T_per_m_ = 0.0;
};

}  // namespace lodestone::physics
