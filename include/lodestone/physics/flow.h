#pragma once

#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::physics {

/// Where and which way fluid moves.
enum class FlowKind { kNone, kUniform, kChannel, kVortex };
inline std::vector<std::string> names_of(FlowKind) { return {"none", "uniform", "channel", "vortex"}; }

/// How its speed changes with time.
enum class FlowWaveform { kSteady, kSine, kListed };
inline std::vector<std::string> names_of(FlowWaveform) { return {"steady", "sine", "listed"}; }

/// A flow that something outside the dish keeps up.
struct FlowConfig {
  FlowKind kind = FlowKind::kNone;
  double speed_m_s = 0.0;
  double direction_deg = 0.0;
  std::vector<double> centre_m = {0.0, 0.0};
  double width_m = 0.02;  // D
  double circulation_m2_s = 0.0;
  double core_radius_m = 5e-3;  // D
  FlowWaveform waveform = FlowWaveform::kSteady;
  double period_s = 1.0;   // D: a heart at rest
  double amplitude = 1.0;  // D: just to a halt, once in a period
  std::vector<double> factors;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("kind", kind, "",
            "none: the fluid rests; uniform: the same everywhere; channel: between two parallel walls "
            "(Poiseuille), at rest beyond them; vortex: round about a core (Lamb and Oseen)");
    v.field("speed_m_s", speed_m_s, "m/s", "of uniform: its speed; of channel: on the middle line",
            {0.0, 1.0});
    v.field("direction_deg", direction_deg, "deg",
            "of uniform and channel: where to, counter-clockwise from +x", {-360.0, 360.0});
    v.field("centre_m", centre_m, "m",
            "[x, y] from the dish centre: of channel a point of its middle line, of vortex its axis",
            {-0.5, 0.5});
    v.field("width_m", width_m, "m", "of channel: from wall to wall", {1e-4, 1.0});
    v.field("circulation_m2_s", circulation_m2_s, "m^2/s",
            "of vortex: far from the core, counter-clockwise; 2 pi times distance times speed there",
            {-0.1, 0.1});
    v.field("core_radius_m", core_radius_m, "m",
            "of vortex: within it the fluid turns nearly as a solid body does", {1e-4, 0.5});
    v.field("waveform", waveform, "",
            "what multiplies every velocity. steady: 1; sine: 1 + amplitude sin(2 pi t / period_s); listed: "
            "factors, at even times of a period, straight between them and round to the first");
    v.field("period_s", period_s, "s", "of sine and listed", {0.01, 3600.0});
    v.field("amplitude", amplitude, "", "of sine; above 1 the flow turns back for a part of the period",
            {0.0, 100.0});
    v.field("factors", factors, "", "of listed: two of them at least", {-100.0, 100.0});
  }
  /// Throws ConfigError when centre_m is no point, or a listed waveform is no list.
  void validate() const;
};

/// The velocity of the fluid at the height of a needle that lies in it. What is given is there at any time,
/// whatever lies in the dish: neither its wall nor an obstacle nor the needle turns the fluid aside.
class Flow {
 public:
  /// Fluid at rest.
  Flow() = default;
  /// Throws ConfigError.
  explicit Flow(const FlowConfig& config);

  /// Whether the fluid rests everywhere and always.
  bool still() const { return still_; }
  /// Velocity (m/s, dish frame) at a point (m, dish frame), at a time from the clock's beginning on.
  geometry::Vector2 velocity_m_s(const geometry::Vector2& point_m, double time_s) const;

 private:
  geometry::Vector2 steady_m_s(const geometry::Vector2& point_m) const;
  double factor(double time_s) const;

  FlowConfig config_;
  bool still_ = true;
  geometry::Vector2 along_ = {1.0, 0.0};
  geometry::Vector2 centre_m_ = {0.0, 0.0};
};

}  // namespace lodestone::physics
