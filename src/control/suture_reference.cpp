#include "lodestone/control/suture_reference.h"

#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::control {
namespace {

constexpr double kSlack_s = 5e-7;  // times are sums of periods

}  // namespace

SutureReference::SutureReference(const std::vector<geometry::Stitch>& stitches,
                                 const SutureReferenceConfig& config)
    : config_(config) {
  LODESTONE_CHECK(!stitches.empty(), "at least one stitch to lead a needle through");
  for (const geometry::Stitch& stitch : stitches)
    ways_.push_back(geometry::way_through(stitch, config.approach_m, config.leave_m));
}

void SutureReference::reset() {
  stitch_ = 0;
  since_s_ = 0.0;
  pushed_s_ = -1.0;
  heading_rad_.reset();
}

bool SutureReference::arrived(const geometry::Pose2& needle) const {
  const double off_rad = geometry::wrap_angle(needle.heading_rad - way().heading_rad(0.0).value());
  return (needle.position_m() - way().at(0.0)).norm() <= config_.arrive_m &&
         geometry::kDegPerRad * std::abs(off_rad) <= config_.arrive_deg;
}

double SutureReference::arc_m(double time_s) const {
  return approaching() ? 0.0 : config_.speed_m_s * (time_s - pushed_s_);
}

bool SutureReference::through(double time_s) const {
  return !approaching() && time_s - pushed_s_ >= way().length_m() / config_.speed_m_s - kSlack_s;
}

geometry::Vector2 SutureReference::target(double time_s, const geometry::Pose2& needle) {
  if (through(time_s) && stitch_ + 1 < ways_.size()) {
    ++stitch_;
    since_s_ = time_s;
    pushed_s_ = -1.0;
  }
  const bool waited = time_s - since_s_ >= config_.arrive_limit_s - kSlack_s;
  if (approaching() && (arrived(needle) || waited)) pushed_s_ = time_s;
  heading_rad_ = way().heading_rad(arc_m(time_s));
  return way().at(arc_m(time_s));
}

std::vector<task::TargetAhead> SutureReference::ahead(double time_s, double step_s, int count) const {
  std::vector<task::TargetAhead> points;
  for (int step = 1; step <= count && !approaching(); ++step) {
    const double in_s = step_s * step;
    const double then_m = arc_m(time_s + in_s);  // an open way ends at its end
    points.push_back({way().at(then_m), in_s, way().heading_rad(then_m)});
  }
  return points;
}

bool SutureReference::finished(double time_s) const { return stitch_ + 1 == ways_.size() && through(time_s); }

}  // namespace lodestone::control
