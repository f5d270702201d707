#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::exports {

/// Messages of a rig's log, as protobuf: those of package `foxglove` have the fields and numbers of
/// Foxglove's published schemas (https://docs.foxglove.dev/docs/visualization/message-schemas), those of
/// package `lodestone` are ours, with units in their names. Times are in nanoseconds, lengths in metres.

/// A FileDescriptorSet with message `name` (such as "foxglove.Log") and all that it needs.
std::string file_descriptor_set(const std::string& name);

enum class LogLevel { kInfo = 2, kWarning = 3, kError = 4 };

std::string compressed_image_message(std::uint64_t time_ns, const std::string& frame_id,
                                     std::string_view jpeg);
/// In the plane z = 0 of the frame.
std::string pose_in_frame_message(std::uint64_t time_ns, const std::string& frame_id,
                                  const geometry::Pose2& pose);
/// `child` lies in `parent` as the pose says.
std::string frame_transform_message(std::uint64_t time_ns, const std::string& parent,
                                    const std::string& child, const geometry::Pose2& pose);
std::string log_message(std::uint64_t time_ns, LogLevel level, const std::string& text);

/// As many as the rig has: four are +x, -x, +y, -y.
using OfCoils = std::vector<double>;

/// lodestone.CoilPulse: what the coils were asked for.
std::string coil_pulse_message(std::uint64_t time_ns, const OfCoils& current_A);

/// What the coils reported; what they do not measure is absent.
struct CoilReading {
  std::optional<OfCoils> current_A, temperature_C;
  std::optional<double> supply_V;
  std::vector<std::string> faults;
};
/// lodestone.CoilStatus.
std::string coil_status_message(std::uint64_t time_ns, const CoilReading& reading);

/// What is known of one step of the control loop, besides poses and currents.
struct StepFacts {
  bool sensed = false;            ///< a pose was found
  std::string reason;             ///< why not
  std::optional<double> error_m;  ///< from the needle to its target
  std::optional<double> position_sigma_m, heading_sigma_rad;
  std::vector<double> action;                                  ///< in [-1, 1]; none where nothing was done
  std::optional<double> log_drive_gain, log_drive_gain_sigma;  ///< as identified
  bool rig_changed = false;
};
/// lodestone.Step.
std::string step_message(std::uint64_t time_ns, const StepFacts& facts);

}  // namespace lodestone::exports
