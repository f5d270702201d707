#include "lodestone/physics/flow.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::physics {

void FlowConfig::validate() const {
  if (centre_m.size() != 2) throw common::InvalidConfig("centre_m", centre_m, "hold [x, y]");
  if (waveform == FlowWaveform::kListed && factors.size() < 2)
    throw common::InvalidConfig("factors", factors, "hold two factors at least where waveform is listed");
}

Flow::Flow(const FlowConfig& config) : config_(config) {
  config.validate();
  const double direction_rad = geometry::kRadPerDeg * config.direction_deg;
  along_ = {std::cos(direction_rad), std::sin(direction_rad)};
  centre_m_ = {config.centre_m[0], config.centre_m[1]};
  still_ = config.kind == FlowKind::kNone ||
           (config.kind == FlowKind::kVortex ? config.circulation_m2_s : config.speed_m_s) == 0.0;
}

/// Poiseuille between two parallel walls, and the vortex of Lamb and Oseen with a core that stays as it is
/// (Batchelor, An Introduction to Fluid Dynamics, 1967; Saffman, Vortex Dynamics, 1992).
geometry::Vector2 Flow::steady_m_s(const geometry::Vector2& point_m) const {
  const geometry::Vector2 from_m = point_m - centre_m_;
  switch (config_.kind) {
    case FlowKind::kNone:
      break;
    case FlowKind::kUniform:
      return config_.speed_m_s * along_;
    case FlowKind::kChannel: {
      const double of_half = 2.0 * (along_.x() * from_m.y() - along_.y() * from_m.x()) / config_.width_m;
      return config_.speed_m_s * std::max(0.0, 1.0 - of_half * of_half) * along_;
    }
    case FlowKind::kVortex: {
      const double core_m2 = config_.core_radius_m * config_.core_radius_m;
      const double cores = from_m.squaredNorm() / core_m2;
      const double share = cores > 0.0 ? -std::expm1(-cores) / cores : 1.0;
      const double spin_rad_s = config_.circulation_m2_s / (2.0 * geometry::kPi * core_m2) * share;
      return {-spin_rad_s * from_m.y(), spin_rad_s * from_m.x()};
    }
  }
  return {0.0, 0.0};
}

double Flow::factor(double time_s) const {
  if (config_.waveform == FlowWaveform::kSteady) return 1.0;
  const double periods = time_s / config_.period_s;
  const double phase = periods - std::floor(periods);
  if (config_.waveform == FlowWaveform::kSine)
    return 1.0 + config_.amplitude * std::sin(2.0 * geometry::kPi * phase);
  const std::vector<double>& factors = config_.factors;
  const double place = phase * static_cast<double>(factors.size());
  const std::size_t before = std::min(static_cast<std::size_t>(place), factors.size() - 1);
  const double after = factors[(before + 1) % factors.size()];
  return factors[before] + (place - static_cast<double>(before)) * (after - factors[before]);
}

geometry::Vector2 Flow::velocity_m_s(const geometry::Vector2& point_m, double time_s) const {
  if (still_) return {0.0, 0.0};
  return factor(time_s) * steady_m_s(point_m);
}

}  // namespace lodestone::physics
