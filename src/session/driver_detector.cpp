#include "lodestone/session/driver_detector.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/clock.h"
#include "lodestone/common/shown.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/rig/driver_stream.h"

namespace lodestone::session {

namespace {
constexpr double kOldest_s = 60.0;
constexpr double kFarthest_m = 10.0;
constexpr double kTurns_rad = 1e3;
constexpr double kSurest = 1.0 - 1e-6;  // nobody is sure of anything
}  // namespace

vision::Sighting driver_sighting(const rig::DriverReply& reply, double now_s, bool sphere) {
  vision::Sighting sighting;
  sighting.stamp_s = now_s - reply.number("age_s", 0.0, kOldest_s);
  if (!reply.content.contains("x_m")) {
    const common::Json reason = reply.content.value("reason", common::Json("the driver sees no needle"));
    sighting.reason =
        common::shown(reason.is_string() ? reason.get<std::string>() : common::shown_json(reason));
    return sighting;
  }
  vision::Rod rod;
  rod.pose = {reply.number("x_m", -kFarthest_m, kFarthest_m), reply.number("y_m", -kFarthest_m, kFarthest_m),
              sphere ? 0.0 : geometry::wrap_angle(reply.number("heading_rad", -kTurns_rad, kTurns_rad))};
  const double sigma_m = reply.number("sigma_m", 1e-6, kFarthest_m);
  const double sigma_rad = sphere ? 0.0 : reply.number("sigma_rad", 1e-6, geometry::kPi);
  rod.covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad;
  const double head =
      reply.content.contains("head_certainty") ? reply.number("head_certainty", 0.5, 1.0) : 1.0;
  rod.head_certainty = std::min(head, kSurest);
  rod.tape_log_odds = std::log(rod.head_certainty / (1.0 - rod.head_certainty));
  rod.found = rod.axis_found = true;
  rod.support = 1.0;
  sighting.candidates.push_back(rod);
  return sighting;
}

DriverDetector::DriverDetector(const rig::DriverConfig& config, const physics::NeedleConfig& needle)
    : sphere_(needle.is_sphere()),
      link_(
          [&config] {
            return rig::open_driver_stream(config.sensor, config.start_timeout_s, "rig.driver.sensor");
          },
          "sensor", common::Json::object(), config.start_timeout_s, config.reply_timeout_s) {}

DriverDetector::DriverDetector(const rig::DriverConfig& config, const physics::NeedleConfig& needle,
                               const rig::DriverLink::OpenStream& open)
    : sphere_(needle.is_sphere()),
      link_(open, "sensor", common::Json::object(), config.start_timeout_s, config.reply_timeout_s) {}

vision::Sighting DriverDetector::look() {
  const rig::DriverReply reply = link_.ask({{"do", "pose"}});
  return driver_sighting(reply, common::SteadyClock().now_s(), sphere_);
}

}  // namespace lodestone::session
