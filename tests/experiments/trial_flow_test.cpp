#include "lodestone/experiments/trial_flow.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/experiments/deployment_job.h"
#include "lodestone/physics/needle.h"
#include "sphere_rig.h"

using namespace lodestone;
using experiments::flow_by_drag;
using experiments::TrialFlow;

TEST_CASE("a flow's drag is half of what friction holds, where it is fastest") {
  const physics::RigDescription rig;
  const physics::FlowConfig pulsing = flow_by_drag(TrialFlow::kPulsing, rig);
  const double peak_m_s = pulsing.speed_m_s * (1.0 + pulsing.amplitude);
  CHECK(physics::broadside_drag_N(rig.needle, rig.fluid, peak_m_s) == Approx(0.5 * rig.breakaway_N()));
  CHECK(pulsing.waveform == physics::FlowWaveform::kSine);
  const physics::FlowConfig steady = flow_by_drag(TrialFlow::kSteady, rig);
  CHECK(steady.waveform == physics::FlowWaveform::kSteady);
  CHECK(steady.speed_m_s == Approx(peak_m_s));
  physics::RigDescription smooth = rig;
  smooth.friction.static_coefficient = smooth.friction.kinetic_coefficient = 0.0;
  CHECK_THROWS_WITH(flow_by_drag(TrialFlow::kPulsing, smooth), Catch::Contains("friction"));
  smooth = rig;
  smooth.needle = tests::sphere();
  CHECK_THROWS_AS(flow_by_drag(TrialFlow::kSteady, smooth), common::ConfigError);
}

TEST_CASE("trials are asked for in a flow, in which their virtual rig then is, and in no other") {
  experiments::DeployConfig config;
  CHECK(experiments::in_flow(config).rig.simulation.flow.kind == physics::FlowKind::kNone);
  config.flow = TrialFlow::kPulsing;
  config.deployment = experiments::in_flow(config);
  CHECK(config.deployment.rig.simulation.flow.kind == physics::FlowKind::kUniform);
  CHECK(config.deployment.rig.simulation.flow.speed_m_s > 0.0);
  CHECK(experiments::in_flow(config).rig.simulation.flow.speed_m_s ==
        config.deployment.rig.simulation.flow.speed_m_s);  // as a run's own configuration has it
  config.flow = TrialFlow::kSteady;
  CHECK_THROWS_WITH(experiments::in_flow(config), Catch::Contains("rig.simulation.flow"));
  config.deployment.rig.simulation.flow = {};
  config.deployment.rig.simulation.flow.direction_deg = 90.0;
  CHECK_THROWS_WITH(experiments::in_flow(config), Catch::Contains("rig.simulation.flow"));
  config.deployment.rig.simulation.flow = {};
  config.deployment.rig.backend = rig::Backend::kSerial;
  CHECK_THROWS_WITH(experiments::in_flow(config), Catch::Contains("flow = \"steady\""));
}
