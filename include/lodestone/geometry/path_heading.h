#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// How a needle shall lie along a path: any way, along the direction of travel, at one heading all the way,
/// or at one that is given for each of the path's points.
enum class HeadingRule { kNone, kTangent, kFixed, kColumn };
inline std::vector<std::string> names_of(HeadingRule) { return {"none", "tangent", "fixed", "column"}; }

/// The heading that is wanted along a path (geometry::Path). Headings are in rad, as Pose2 has them.
class PathHeading {
 public:
  /// None.
  PathHeading() = default;
  static PathHeading tangent() { return {HeadingRule::kTangent, {}}; }
  static PathHeading fixed(double heading_rad) { return {HeadingRule::kFixed, {heading_rad}}; }
  /// One for each point of the path. Between two of them it turns evenly along the way, and the shorter way
  /// around.
  static PathHeading column(std::vector<double> heading_rad) {
    return {HeadingRule::kColumn, std::move(heading_rad)};
  }

  HeadingRule rule() const { return rule_; }
  /// Points that a heading is given for.
  std::size_t points() const { return rule_ == HeadingRule::kColumn ? heading_rad_.size() : 0; }

  /// In (-pi, pi], on the way from a point to the next, which leads along `way_m`, where the fraction `share`
  /// of it lies behind; nothing by the rule kNone.
  std::optional<double> at(std::size_t point, double share, const Vector2& way_m) const;

 private:
  PathHeading(HeadingRule rule, std::vector<double> heading_rad)
      : rule_(rule), heading_rad_(std::move(heading_rad)) {}

  HeadingRule rule_ = HeadingRule::kNone;
  std::vector<double> heading_rad_;  // the one that is fixed, or one for each point
};

}  // namespace lodestone::geometry
