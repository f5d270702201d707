#include "lodestone/task/observation.h"

#include <cmath>

namespace lodestone::task {

int ObservationEncoder::size() const {
  const int heading = config_.heading == "none" ? 0 : config_.heading == "angle" ? 1 : 2;
  return 2 + heading + (config_.target ? 2 : 0) + (config_.relative_target ? 2 : 0) +
         (config_.memory ? 4 : 0);
}

void ObservationEncoder::encode(const Observation& observation, float* out) const {
  const auto put = [&out](const geometry::Vector2& vector, double scale) {
    *out++ = static_cast<float>(vector.x() / scale);
    *out++ = static_cast<float>(vector.y() / scale);
  };
  const geometry::Vector2 position_m = observation.pose.position_m();
  put(position_m, config_.length_scale_m);
  if (config_.heading == "angle") {
    *out++ = static_cast<float>(observation.pose.heading_rad);
  } else if (config_.heading == "sine_cosine") {
    *out++ = static_cast<float>(std::sin(observation.pose.heading_rad));
    *out++ = static_cast<float>(std::cos(observation.pose.heading_rad));
  }
  if (config_.target) put(observation.target_m, config_.length_scale_m);
  if (config_.relative_target) put(observation.target_m - position_m, config_.length_scale_m);
  if (config_.memory) {
    put(observation.last_action, 1.0);
    put(observation.last_displacement_m, config_.displacement_scale_m);
  }
}

}  // namespace lodestone::task
