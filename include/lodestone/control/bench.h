#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "lodestone/common/clock.h"
#include "lodestone/control/safety_supervisor.h"
#include "lodestone/control/sensing.h"
#include "lodestone/rig/rig_config.h"

namespace lodestone::control {

/// A rig ready to be driven: coils behind the supervisor, a sensor, a clock, and somebody who lays the needle
/// down.
class Bench {
 public:
  virtual ~Bench() = default;
  virtual SafetySupervisor& coils() = 0;
  virtual PoseSensor& sensor() = 0;
  virtual common::Clock& clock() = 0;
  /// Whether the needle would lie inside the wall.
  virtual bool fits(const geometry::Pose2& pose) const = 0;
  /// Has the needle laid there; on a real bench about there. The sensor forgets where it was.
  virtual void lay(const geometry::Pose2& pose) = 0;
  /// Null when there are no pictures.
  virtual const CameraPoseSensor* camera() const = 0;
  /// Where the needle really is, for scoring only; empty where nobody knows.
  virtual std::optional<geometry::Pose2> true_pose() const = 0;
  /// Everything that changes, between two episodes; null on a real bench, which cannot be put back.
  virtual common::Json save() const = 0;
  virtual void restore(const common::Json& state) = 0;
};

/// Random streams of a virtual bench.
struct VirtualBenchSeeds {
  std::uint64_t rig = 1;
  std::uint64_t scene = 1;
  common::RandomStream sensor_noise{1, "sensor noise"};
  std::optional<common::RandomStream> scatter;  ///< of the friction from pulse to pulse; empty: the rig's own
};

/// A virtual rig with a calibrated sensor. With `realtime`, time passes as on a real bench.
std::unique_ptr<Bench> make_virtual_bench(const rig::VirtualRigConfig& rig, const SensingConfig& sensing,
                                          const SafetyConfig& safety, const VirtualBenchSeeds& seeds,
                                          bool realtime = false);

/// Asks an operator to lay the needle near a pose and returns once that is done.
using AskOperator = std::function<void(const geometry::Pose2& pose)>;

/// The bench on the serial port, under its camera. Pictures are calibrated from `sensing.calibration`, or
/// from the first one. Any key in the terminal stops. Without `ask`, lay() throws. Throws HardwareError,
/// IoError, ConfigError and CheckpointError when a part is missing.
std::unique_ptr<Bench> make_real_bench(const rig::RigConfig& rig, const SensingConfig& sensing,
                                       const SafetyConfig& safety, AskOperator ask = {});

}  // namespace lodestone::control
