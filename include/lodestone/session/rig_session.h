#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "lodestone/common/clock.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/ground_truth.h"
#include "lodestone/session/operator.h"
#include "lodestone/session/sensing.h"

namespace lodestone::session {

/// A rig ready to be driven: coils behind the supervisor, a sensor, a clock, and somebody who places the
/// needle.
class RigSession {
 public:
  /// What a rig is made of.
  struct Parts {
    std::shared_ptr<void> owner;  ///< of all that the others point to
    safety::Supervisor* coils = nullptr;
    control::PoseSensor* sensor = nullptr;
    common::Clock* clock = nullptr;
    Operator* needle_operator = nullptr;
    std::function<bool(const geometry::Pose2&)> fits;
    const CameraDetector* camera = nullptr;           ///< null where there are no images
    const rig::FreeRunningCamera* watched = nullptr;  ///< null where images come only when the sensor asks
    GroundTruth* truth = nullptr;             ///< null on a real or emulated rig: nobody knows it there
    std::function<void()> clear_faults = {};  ///< empty where the coils latch none
  };
  explicit RigSession(Parts parts) : parts_(std::move(parts)) {}

  safety::Supervisor& coils() { return *parts_.coils; }
  control::PoseSensor& sensor() { return *parts_.sensor; }
  common::Clock& clock() { return *parts_.clock; }
  /// Whether the needle would lie inside the wall.
  bool fits(const geometry::Pose2& pose) const { return parts_.fits(pose); }
  /// Has the needle placed there, with the coils off; on a real bench about there. The sensor forgets where
  /// it was.
  void place(const geometry::Pose2& pose);
  const CameraDetector* camera() const { return parts_.camera; }
  /// Has the coil controller forget the faults that it has latched; those that persist come back at once. An
  /// operator's decision, never a program's. Throws HardwareError.
  void clear_faults() {
    if (parts_.clear_faults) parts_.clear_faults();
  }
  /// The newest image, at once, from any thread; null where there is none, or where images come only when the
  /// sensor asks.
  std::shared_ptr<const imaging::Frame> latest_image() const {
    return parts_.watched != nullptr ? parts_.watched->latest() : nullptr;
  }
  GroundTruth* truth() const { return parts_.truth; }

 private:
  Parts parts_;
};

/// Random streams of a virtual bench.
struct VirtualSeeds {
  std::uint64_t rig = 1;
  std::uint64_t scene = 1;
  common::RandomStream sensor_noise{1, "sensor noise"};
  std::optional<common::RandomStream> scatter;  ///< of the friction from pulse to pulse; empty: the rig's own
};

/// A virtual rig with a calibrated sensor. With `realtime`, time passes as on a real bench.
std::unique_ptr<RigSession> make_virtual_session(const rig::VirtualRigConfig& rig,
                                                 const SensingConfig& sensing,
                                                 const safety::SafetyConfig& safety,
                                                 const VirtualSeeds& seeds, bool realtime = false);

/// A real bench (or an emulated one): the coils on the serial port or behind a driver, under a camera or a
/// driver that sees the needle. With a `folder`, the file STOP in it stops the bench where
/// `safety` names none. Images are calibrated from `sensing.calibration`, or
/// from the first one. Any key in the terminal stops. Without `ask`, place() throws. Throws HardwareError,
/// IoError, ConfigError and CheckpointError when a part is missing.
std::unique_ptr<RigSession> make_bench_session(const rig::RigConfig& rig, const SensingConfig& sensing,
                                               safety::SafetyConfig safety, AskedOperator::Ask ask = {},
                                               const std::string& folder = "");

}  // namespace lodestone::session
