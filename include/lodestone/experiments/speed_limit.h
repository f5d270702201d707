#pragma once

#include "lodestone/control/control_loop.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::experiments {

/// How fast in m/s at least a needle can be carried along the sides of a square about the dish centre, as far
/// as the described physics goes (physics::PlainSimulator): what the fullest drive along a side moves a
/// needle that lies along it in one control period, over that period, where it moves it least on the first
/// halves of the sides. The wall ends a motion that is faster, so that no more than that is told. How exactly
/// it then lies is another question. 0 where friction holds it somewhere.
double square_speed_limit_m_s(const physics::RigDescription& rig, double side_m,
                              const control::ControlLoopConfig& loop);

}  // namespace lodestone::experiments
