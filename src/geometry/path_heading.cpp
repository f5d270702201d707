#include "lodestone/geometry/path_heading.h"

#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::geometry {

std::optional<double> PathHeading::at(std::size_t point, double share, const Vector2& way_m) const {
  switch (rule_) {
    case HeadingRule::kNone:
      break;
    case HeadingRule::kTangent:
      return wrap_angle(std::atan2(way_m.y(), way_m.x()));
    case HeadingRule::kFixed:
      return wrap_angle(heading_rad_.front());
    case HeadingRule::kColumn: {
      const double from_rad = heading_rad_.at(point);
      return wrap_angle(from_rad + share * wrap_angle(heading_rad_.at(point + 1) - from_rad));
    }
  }
  return std::nullopt;
}

}  // namespace lodestone::geometry
