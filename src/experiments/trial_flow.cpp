#include "lodestone/experiments/trial_flow.h"

#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/physics/needle.h"

namespace lodestone::experiments {

physics::FlowConfig flow_by_drag(TrialFlow kind, const physics::RigDescription& rig) {
  constexpr double kShareOfFriction = 0.5;
  constexpr double kMost_m_s = 1.0;  // that rig.simulation.flow.speed_m_s may be
  LODESTONE_CHECK(kind != TrialFlow::kAsRig, "a flow that is asked for");
  const bool pulsing = kind == TrialFlow::kPulsing;
  const double fastest_over_mean = pulsing ? 2.0 : 1.0;
  const double drag_N = kShareOfFriction * rig.breakaway_N();
  if (rig.needle.is_sphere() || drag_N <= 0.0 ||
      physics::broadside_drag_N(rig.needle, rig.fluid, fastest_over_mean * kMost_m_s) <= drag_N)
    throw common::ConfigError(
        "flow = \"" + common::name_of(kind) +
        "\": a flow whose drag is half of what friction holds needs a rig with a needle on which friction is "
        "above 0, and a fluid whose drag can be half of it; leave the flow out");
  const double fastest_m_s = physics::broadside_speed_m_s(rig.needle, rig.fluid, drag_N);
  physics::FlowConfig flow;
  flow.kind = physics::FlowKind::kUniform;
  flow.amplitude = 1.0;
  flow.period_s = 1.0;
  flow.waveform = pulsing ? physics::FlowWaveform::kSine : physics::FlowWaveform::kSteady;
  flow.speed_m_s = fastest_m_s / fastest_over_mean;
  return flow;
}

}  // namespace lodestone::experiments
