#pragma once

namespace lodestone::physics {

constexpr double kNominalFluid_C = 22.0;          // D: what the fluid's default viscosity is for
constexpr double kGlycerolMassFraction = 0.2016;  // Q: 25 ml of water and 5 ml of glycerol

/// Dynamic viscosity of water with glycerol between 0 and 100 C (Cheng, Ind. Eng. Chem. Res. 47, 2008, eq. 6
/// to 12).
double water_glycerol_viscosity_Pa_s(double temperature_C,
                                     double glycerol_mass_fraction = kGlycerolMassFraction);

}  // namespace lodestone::physics
