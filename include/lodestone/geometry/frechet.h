#pragma once

#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// The discrete Frechet distance of two polylines: the shortest leash on which two walkers can go from vertex
/// to vertex, each along its own line and never back (Eiter and Mannila, Computing discrete Frechet distance,
/// 1994). Each has at least one point.
double discrete_frechet_m(const std::vector<Vector2>& a_m, const std::vector<Vector2>& b_m);

}  // namespace lodestone::geometry
