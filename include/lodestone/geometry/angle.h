#pragma once
namespace lodestone::geometry {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegPerRad = 180.0 / kPi;
constexpr double kRadPerDeg = kPi / 180.0;

/// The same angle in (-pi, pi], radians.
double wrap_angle(double angle_rad);

}  // namespace lodestone::geometry
