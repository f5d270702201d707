#include "lodestone/experiments/trial_flow.h"

#include "lodestone/common/error.h"
#include "lodestone/physics/needle.h"

namespace lodestone::experiments {

physics::FlowConfig flow_by_drag(TrialFlow kind, const physics::RigDescription& rig) {
  constexpr double kShareOfFriction = 0.5;
  constexpr double kFastest_m_s = 2.0;
  LODESTONE_CHECK(kind != TrialFlow::kAsRig, "a flow that is asked for");
  const double drag_N = kShareOfFriction * rig.breakaway_N();
  if (rig.needle.is_sphere() || drag_N <= 0.0 ||
      physics::broadside_drag_N(rig.needle, rig.fluid, kFastest_m_s) <= drag_N)
    throw common::ConfigError(
        "a flow whose drag is half of what friction holds needs a rig with a needle on which friction is "
        "above 0, and a fluid whose drag can be half of it; leave the flow out");
  const double fastest_m_s = physics::broadside_speed_m_s(rig.needle, rig.fluid, drag_N);
  physics::FlowConfig flow;
  flow.kind = physics::FlowKind::kUniform;
  flow.amplitude = 1.0;
  flow.period_s = 1.0;
  const bool pulsing = kind == TrialFlow::kPulsing;
  flow.waveform = pulsing ? physics::FlowWaveform::kSine : physics::FlowWaveform::kSteady;
  flow.speed_m_s = pulsing ? fastest_m_s / (1.0 + flow.amplitude) : fastest_m_s;
  return flow;
}

}  // namespace lodestone::experiments
