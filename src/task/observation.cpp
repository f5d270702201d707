#include "lodestone/task/observation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lodestone::task {
namespace {

constexpr double kLeastLengthScale_m = 1e-3;
constexpr double kMostLengthScale_m = 1.0;

}  // namespace

DriveGain draw_gain_estimate(double sigma, double least_sigma, common::RandomStream& random) {
  DriveGain estimate;
  const double least = std::min(sigma, least_sigma);
  const double share = random.uniform();
  if (sigma <= 0.0) return estimate;
  estimate.log_sigma = least > 0.0 ? least * std::pow(sigma / least, share) : share * sigma;
  estimate.log_mean = std::sqrt(sigma * sigma - estimate.log_sigma * estimate.log_sigma) * random.normal();
  return estimate;
}

common::Json encoder_to_json(const EncoderConfig& config) {
  common::Json json = common::config_to_json(config);
  json["length_scale_m"] = config.length_scale_m;
  json["action_size"] = config.action_size;
  return json;
}

EncoderConfig encoder_from_json(common::Json json, const std::string& what) {
  const double length_scale_m = json.at("length_scale_m").get<double>();
  if (!(length_scale_m >= kLeastLengthScale_m && length_scale_m <= kMostLengthScale_m))
    throw common::ConfigError(what + ": length_scale_m = " + common::shown_json(json["length_scale_m"]) +
                              " must be within 0.001 .. 1");
  const auto action_size = json.value("action_size", std::int64_t{EncoderConfig{}.action_size});
  if (action_size < 1 || action_size > geometry::kMostDrives)
    throw common::ConfigError(what + ": action_size = " + common::shown_json(json["action_size"]) +
                              " must be within 1 .. 16");
  for (const char* key : {"length_scale_m", "action_size"}) json.erase(key);
  auto config = common::config_from_json<EncoderConfig>(json, what);
  config.length_scale_m = length_scale_m;
  config.action_size = static_cast<int>(action_size);
  return config;
}

int ObservationEncoder::heading_size() const {
  switch (config_.heading) {
    case HeadingEncoding::kAngle:
      return 1;
    case HeadingEncoding::kSineCosine:
      return 2;
    case HeadingEncoding::kNone:
      break;
  }
  return 0;
}

int ObservationEncoder::size() const {
  return 2 + heading_size() + (config_.target ? 2 : 0) + relative_size() + (config_.target_heading ? 2 : 0) +
         (config_.memory ? config_.action_size + 2 : 0) + (config_.drive_gain ? 2 : 0);
}

int ObservationEncoder::relative_size() const {
  if (!config_.relative_target) return 0;
  return config_.fine_distance_m > 0.0 ? 3 : 2;
}

void ObservationEncoder::put_relative(const geometry::Vector2& vector_m, float*& out) const {
  const double fine_m = config_.fine_distance_m;
  const double length_m = vector_m.norm();
  const double unit_m = fine_m > 0.0 ? std::hypot(length_m, fine_m) : config_.length_scale_m;
  *out++ = static_cast<float>(vector_m.x() / unit_m);
  *out++ = static_cast<float>(vector_m.y() / unit_m);
  if (fine_m > 0.0)
    *out++ = static_cast<float>(std::log1p(length_m / fine_m) / std::log1p(config_.length_scale_m / fine_m));
}

void ObservationEncoder::encode(const Observation& observation, float* out) const {
  const auto put = [&out](const geometry::Vector2& vector, double scale) {
    *out++ = static_cast<float>(vector.x() / scale);
    *out++ = static_cast<float>(vector.y() / scale);
  };
  const geometry::Vector2 position_m = observation.pose.position_m();
  const std::size_t pulses_ahead = config_.target_ahead ? 1 : 0;
  const geometry::Vector2 target_m = observation.target_after_m(pulses_ahead);
  put(position_m, config_.length_scale_m);
  if (config_.heading == HeadingEncoding::kAngle) {
    *out++ = static_cast<float>(observation.pose.heading_rad);
  } else if (config_.heading == HeadingEncoding::kSineCosine) {
    *out++ = static_cast<float>(std::sin(observation.pose.heading_rad));
    *out++ = static_cast<float>(std::cos(observation.pose.heading_rad));
  }
  if (config_.target) put(target_m, config_.length_scale_m);
  if (config_.relative_target) put_relative(target_m - position_m, out);
  if (config_.target_heading) {
    const double heading_rad = observation.pose.heading_rad;
    const double turn_rad =
        observation.target_heading_after_rad(pulses_ahead).value_or(heading_rad) - heading_rad;
    *out++ = static_cast<float>(std::sin(turn_rad));
    *out++ = static_cast<float>(std::cos(turn_rad));
  }
  if (config_.memory) {
    const geometry::Drive& last = observation.last_action;
    for (Eigen::Index i = 0; i < config_.action_size; ++i)
      *out++ = i < last.size() ? static_cast<float>(last[i]) : 0.0F;
    put(observation.last_displacement_m, config_.displacement_scale_m);
  }
  if (config_.drive_gain) {
    const DriveGain gain = observation.drive_gain.value_or(DriveGain{});
    *out++ = static_cast<float>(gain.log_mean);
    *out++ = static_cast<float>(gain.log_sigma);
  }
}

geometry::Vector2 ObservationEncoder::position_m(const float* row) const {
  return config_.length_scale_m * geometry::Vector2(row[0], row[1]);
}

double ObservationEncoder::target_distance_m(const float* row) const {
  const int target = 2 + heading_size();
  if (config_.relative_target) {
    const float* vector = row + target + (config_.target ? 2 : 0);
    const double fine_m = config_.fine_distance_m;
    if (fine_m > 0.0)
      return fine_m *
             std::expm1(static_cast<double>(vector[2]) * std::log1p(config_.length_scale_m / fine_m));
    return config_.length_scale_m * std::hypot(vector[0], vector[1]);
  }
  const geometry::Vector2 at_m = position_m(row);
  return config_.target ? (position_m(row + target) - at_m).norm() : at_m.norm();
}

void ObservationEncoder::retarget(const geometry::Vector2& target_m, float* row) const {
  float* out = row + 2 + heading_size();
  if (config_.target) {
    *out++ = static_cast<float>(target_m.x() / config_.length_scale_m);
    *out++ = static_cast<float>(target_m.y() / config_.length_scale_m);
  }
  if (config_.relative_target) put_relative(target_m - position_m(row), out);
}

}  // namespace lodestone::task
