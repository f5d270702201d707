#include "lodestone/experiments/speed_limit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lodestone/geometry/angle.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/physics/plain_simulator.h"

namespace lodestone::experiments {

double square_speed_limit_m_s(const physics::RigDescription& rig, double side_m,
                              const control::ControlLoopConfig& loop) {
  constexpr int kSides = 4;
  constexpr int kPlaces = 11;  // on the first half of each
  const physics::PlainSimulator simulator(rig, {});
  const physics::CoilDrive drive(rig);
  double least_m = std::numeric_limits<double>::infinity();
  for (int side = 0; side < kSides; ++side) {
    const double heading_rad = geometry::wrap_angle(0.5 * geometry::kPi * side);
    const geometry::Vector2 along(std::cos(heading_rad), std::sin(heading_rad));
    const geometry::Vector2 outwards(along.y(), -along.x());
    for (int place = 0; place < kPlaces; ++place) {
      const double so_far_m = 0.5 * side_m * (static_cast<double>(place) / (kPlaces - 1) - 1.0);
      const geometry::Vector2 at_m = so_far_m * along + 0.5 * side_m * outwards;
      const geometry::Drive fullest_A = rig.coils.max_current_A * drive.along(along, at_m);
      const geometry::Pose2 after = simulator.step(
          {at_m.x(), at_m.y(), heading_rad}, drive.current_A(fullest_A, at_m), loop.pulse_s, loop.rest_s);
      least_m = std::min(least_m, (after.position_m() - at_m).dot(along));
    }
  }
  return std::max(0.0, least_m) / loop.period_s();
}

}  // namespace lodestone::experiments
