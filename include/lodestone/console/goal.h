#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodestone/experiments/deployment.h"
#include "lodestone/geometry/path.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/geometry/stitch.h"

namespace lodestone::console {

/// Where the needle shall go.
struct Goal {
  std::string task;                                        ///< "point", "path", ...; for people
  geometry::Vector2 target_m = geometry::Vector2::Zero();  ///< of a point
  std::optional<double> heading_rad;                       ///< of a point
  std::optional<geometry::Path> path;
  std::vector<geometry::Stitch> stitches;  ///< that this path leads through; empty: it is followed
};

/// Along a path, with the headings that are configured. Throws as experiments::headed_path().
Goal path_goal(const geometry::Path& path, const experiments::DeploymentConfig& config);

/// Through the stitches that are configured. Throws as experiments::check_stitches().
Goal suture_goal(const experiments::DeploymentConfig& config);

}  // namespace lodestone::console
