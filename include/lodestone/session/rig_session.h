#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "lodestone/common/clock.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/sensing.h"

namespace lodestone::session {

/// A rig ready to be driven: coils behind the supervisor, a sensor, a clock, and somebody who places the
/// needle.
class RigSession {
 public:
  virtual ~RigSession() = default;
  virtual safety::Supervisor& coils() = 0;
  virtual control::PoseSensor& sensor() = 0;
  virtual common::Clock& clock() = 0;
  /// Whether the needle would lie inside the wall.
  virtual bool fits(const geometry::Pose2& pose) const = 0;
  /// Has the needle placed there; on a real bench about there. The sensor forgets where it was.
  virtual void place(const geometry::Pose2& pose) = 0;
  /// Null when there are no images.
  virtual const CameraPoseSensor* camera() const = 0;
  /// Where the needle really is, for scoring only; empty where nobody knows.
  virtual std::optional<geometry::Pose2> true_pose() const = 0;
  /// Everything that changes, between two episodes; null on a real bench, which cannot be put back.
  virtual common::Json save() const = 0;
  virtual void restore(const common::Json& state) = 0;
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

/// Asks an operator to place the needle near a pose and returns once that is done.
using AskOperator = std::function<void(const geometry::Pose2& pose)>;

/// The bench on the serial port, under its camera. Images are calibrated from `sensing.calibration`, or
/// from the first one. Any key in the terminal stops. Without `ask`, place() throws. Throws HardwareError,
/// IoError, ConfigError and CheckpointError when a part is missing.
std::unique_ptr<RigSession> make_serial_session(const rig::RigConfig& rig, const SensingConfig& sensing,
                                                const safety::SafetyConfig& safety, AskOperator ask = {});

}  // namespace lodestone::session
