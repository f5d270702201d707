#pragma once

namespace lodestone::physics {

/// Current (A) of a coil without saturation that makes the field that one with a core makes at `current_A`:
/// its winding's share goes on with the current, its core's along a hyperbolic tangent, so that what is
/// lacking grows with the cube of the current first. `core_share`: of the field, at small currents; 0: no
/// core, exactly the current itself. `saturation_A`: at which the core gives 76 % of what it would.
double unsaturated_A(double current_A, double core_share, double saturation_A);

}  // namespace lodestone::physics
