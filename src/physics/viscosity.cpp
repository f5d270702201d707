#include "lodestone/physics/viscosity.h"

#include <cmath>

namespace lodestone::physics {

double water_glycerol_viscosity_Pa_s(double temperature_C, double glycerol_mass_fraction) {
  const double t = temperature_C;
  const double c = glycerol_mass_fraction;
  const double water = 1.790e-3 * std::exp((-1230.0 - t) * t / (36100.0 + 360.0 * t));
  const double glycerol = 12.100 * std::exp((-1233.0 + t) * t / (9900.0 + 70.0 * t));
  const double a = 0.705 - 0.0017 * t;
  const double b = (4.9 + 0.036 * t) * std::pow(a, 2.5);
  const double alpha = 1.0 - c + a * b * c * (1.0 - c) / (a * c + b * (1.0 - c));
  return std::pow(water, alpha) * std::pow(glycerol, 1.0 - alpha);
}

}  // namespace lodestone::physics
