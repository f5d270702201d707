#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::task {

/// Where the target will be.
struct TargetAhead {
  geometry::Vector2 point_m;
  double in_s;
  std::optional<double> heading_rad = {};  ///< to lie at there, where the task wants one
};

/// How strongly a rig answers to a drive, as a factor on the drive: 1 is the rig that a simulator was learned
/// on.
struct DriveGain {
  double log_mean = 0.0;
  double log_sigma = 0.0;
};

/// What a filter may know of a rig whose gain is drawn with `sigma` (of the logarithm): anything between
/// nothing and `least_sigma`, spread by the logarithm. A gain drawn from the estimate has `sigma` again.
DriveGain draw_gain_estimate(double sigma, double least_sigma, common::RandomStream& random);

/// What a controller knows when it decides, in SI units in the dish frame.
struct Observation {
  geometry::Pose2 pose;  ///< as sensed
  geometry::Vector2 target_m = geometry::Vector2::Zero();
  std::vector<TargetAhead>
      ahead;  ///< of a target that moves, one for each of the next steps; empty: it stays
  std::optional<double> target_heading_rad;  ///< where the task wants one
  bool awaited = false;  ///< the task goes on only once the needle has come nearer: lying still leads nowhere
  geometry::Drive last_action = geometry::Drive::Zero(2);             ///< in [-1, 1]^k; zero after a reset
  geometry::Vector2 last_displacement_m = geometry::Vector2::Zero();  ///< sensed motion since the last action
  std::optional<DriveGain> drive_gain;                                ///< where the rig is identified
  /// What a flow carries a needle that lies across it by in each of the next pulses that moves it; empty: the
  /// fluid rests, as far as is known.
  std::vector<geometry::Vector2> drift_m;

  /// The action of the rig's drive that is no pulse.
  geometry::Drive rest() const { return geometry::Drive::Zero(last_action.size()); }

  /// Where the target will be when so many more pulses are over, as far ahead as is known.
  const geometry::Vector2& target_after_m(std::size_t pulses) const {
    if (ahead.empty() || pulses == 0) return target_m;
    return ahead[std::min(pulses, ahead.size()) - 1].point_m;
  }
  /// How the needle shall lie then.
  std::optional<double> target_heading_after_rad(std::size_t pulses) const {
    if (ahead.empty() || pulses == 0) return target_heading_rad;
    const std::optional<double>& then_rad = ahead[std::min(pulses, ahead.size()) - 1].heading_rad;
    return then_rad ? then_rad : target_heading_rad;
  }
};

/// The heading in rad (the paper's), as sine and cosine, or not at all (the recorded sphere has none).
enum class HeadingEncoding { kAngle, kSineCosine, kNone };
inline std::vector<std::string> names_of(HeadingEncoding) { return {"angle", "sine_cosine", "none"}; }

/// How observations become the numbers a policy network sees. Used by training and by deployment alike.
struct EncoderConfig {
  HeadingEncoding heading = HeadingEncoding::kAngle;
  bool target = true;            ///< append the target: the random-target policy
  bool relative_target = false;  ///< append target - position as well
  bool target_heading = false;   ///< append sine and cosine of target heading - heading (0 and 1 without one)
  bool memory = false;           ///< append last action and last displacement: remembers a stall
  bool drive_gain = false;    ///< append what is known of the rig: mean and deviation of its gain's logarithm
  bool target_ahead = false;  ///< the target is where it will be after the pulse, not where it is
  double fine_distance_m = 0.0;  ///< what is near gets more room: see put_relative()
  double displacement_scale_m = 0.005;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("heading", heading, "", "how the heading is given");
    v.field("target", target, "", "append the target position");
    v.field("relative_target", relative_target, "", "append the vector from needle to target");
    v.field("target_heading", target_heading, "",
            "append the turn to the target heading, as sine and cosine");
    v.field("memory", memory, "", "append last action and last displacement");
    v.field(
        "drive_gain", drive_gain, "",
        "append what is known of how strongly the rig answers: mean and deviation of the gain's logarithm");
    v.field("target_ahead", target_ahead, "",
            "the target is where it will be after the pulse, not where it is");
    v.field("fine_distance_m", fine_distance_m, "m",
            "above 0, the vector from needle to target is given as its direction and the logarithm of its "
            "length, "
            "which is as it is below this; 0: as a vector",
            {0.0, 1.0});
    v.retired("length_scale_m", "rig.dish.radius_m");
    v.field("displacement_scale_m", displacement_scale_m, "m", "displacements are divided by this",
            {1e-5, 1.0});
  }

  /// Lengths are divided by it. No key: it is the dish radius, as TaskConfig::dish_radius_m.
  double length_scale_m = 0.0;
  /// Numbers of an action. No key: as ActionConfig::size.
  int action_size = 2;
};

/// An encoder as checkpoints hold it, length scale and action size included, and back. Throws ConfigError
/// naming `what`, and what nlohmann-json throws where the scale is missing.
common::Json encoder_to_json(const EncoderConfig& config);
EncoderConfig encoder_from_json(common::Json json, const std::string& what);

class ObservationEncoder {
 public:
  explicit ObservationEncoder(const EncoderConfig& config) : config_(config) {}

  /// Numbers per observation: 2 + heading (0, 1, 2) + target 2 + relative target (2, 3) + target heading 2 +
  /// memory (action + 2) + drive gain 2.
  int size() const;
  /// Writes size() numbers in the order position, heading, target, relative target, turn to the target
  /// heading, last action, displacement, drive gain.
  void encode(const Observation& observation, float* out) const;

  /// Sensed position in an encoded row.
  geometry::Vector2 position_m(const float* row) const;
  /// Distance to the target in an encoded row; to the centre where the target is not encoded.
  double target_distance_m(const float* row) const;
  /// Writes another target into an encoded row (not its heading).
  void retarget(const geometry::Vector2& target_m, float* row) const;

 private:
  int heading_size() const;
  int relative_size() const;
  /// The vector from needle to target, v, in the network's units: v / L with L = length_scale_m; or, where f
  /// = fine_distance_m is above 0, its direction v / sqrt(|v|^2 + f^2) and log(1 + |v| / f) / log(1 + L / f).
  void put_relative(const geometry::Vector2& vector_m, float*& out) const;

  EncoderConfig config_;
};

}  // namespace lodestone::task
