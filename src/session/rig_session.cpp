#include "lodestone/session/rig_session.h"

#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "lodestone/imaging/calibration.h"
#include "lodestone/rig/driver_coils.h"
#include "lodestone/rig/serial_coils.h"
#include "lodestone/session/driver_detector.h"

namespace lodestone::session {

namespace {

struct VirtualParts final : Operator, GroundTruth {
  VirtualParts(const rig::VirtualRigConfig& config, const SensingConfig& sensing_config,
               const safety::SafetyConfig& safety, const VirtualSeeds& seeds, bool realtime)
      : rig(config, seeds.rig), sensing(sensing_config, config) {
    if (seeds.scatter) {
      common::Json state = rig.save();
      state["scatter"] = seeds.scatter->save();
      rig.restore(state);
    }
    if (realtime) rig.keep_pace_with(wall);
    sensor = sensing.make(rig, sensing.calibrated_bench(seeds.scene), seeds.sensor_noise, nullptr,
                          realtime ? Images::kAllTheTime : Images::kWhenAsked);
    coils.emplace(rig.coils(), safety, config, rig.clock());
  }
  void place(const geometry::Pose2& pose) override { rig.place(pose); }
  geometry::Pose2 true_pose() const override { return rig.true_pose(); }
  common::Json save() const override { return {{"rig", rig.save()}, {"sensor", sensor->save()}}; }
  void load(const common::Json& state) override {
    rig.restore(state.at("rig"));
    sensor->restore(state.at("sensor").get<std::string>());
  }

  common::SteadyClock wall;
  rig::VirtualRig rig;
  Sensing sensing;
  std::unique_ptr<RigSensor> sensor;
  std::optional<safety::Supervisor> coils;
};

/// A real bench, or an emulated one.
struct BenchParts {
  BenchParts(const rig::RigConfig& rig, const SensingConfig& sensing, const safety::SafetyConfig& safety,
             AskedOperator::Ask ask) {
    open_sensor(rig, sensing);
    open_coils(rig);
    coils.emplace(*device, safety, rig, clock, safety::Supervisor::Poses::kRequired, true);
    if (ask)
      needle_operator = std::make_unique<AskedOperator>(std::move(ask));
    else
      needle_operator = std::make_unique<AbsentOperator>();
  }

  void open_sensor(const rig::RigConfig& rig, const SensingConfig& sensing) {
    if (!rig.driver.sensor.empty()) {
      by_driver.emplace(rig.driver, rig.needle);
      sensor.emplace(*by_driver, sensing.tracker, rig, clock);
      return;
    }
    if (sensing.kind != "camera")
      throw common::ConfigError(
          "sensor.kind = \"" + sensing.kind +
          "\": only a camera can see the needle of a real bench; use \"camera\", or rig.driver.sensor");
    const auto segmenter = vision::Segmenter::load(sensing.segmenter);
    std::optional<imaging::Calibration> calibration;
    if (!sensing.calibration.empty()) calibration = imaging::read_calibration(sensing.calibration);
    camera = rig::open_camera(rig.camera);
    if (rig.camera.kind != rig::CameraKind::kFiles) {  // those would run out while nobody looks
      auto running = std::make_unique<rig::FreeRunningCamera>(std::move(camera), sensing.camera.timeout_s);
      watched = running.get();
      camera = std::move(running);
    }
    by_camera.emplace(*camera, segmenter, rig, sensing.scene.lens, sensing.camera, calibration);
    sensor.emplace(*by_camera, sensing.tracker, rig, clock);
  }

  void open_coils(const rig::RigConfig& rig) {
    if (rig.backend == rig::Backend::kDriver) {
      auto driven = std::make_unique<rig::DriverCoils>(rig.driver, rig.coils);
      connected_to = driven->driver();
      clear_faults = [coils = driven.get()] { coils->clear_faults(); };
      device = std::move(driven);
    } else {
      auto serial = std::make_unique<rig::SerialCoils>(rig.serial, rig.coils);
      connected_to = rig.serial.port;
      clear_faults = [coils = serial.get()] { coils->clear_faults(); };
      device = std::move(serial);
    }
  }

  common::SteadyClock clock;
  std::unique_ptr<rig::Camera> camera;
  const rig::FreeRunningCamera* watched = nullptr;
  std::optional<CameraDetector> by_camera;
  std::optional<DriverDetector> by_driver;
  std::optional<TrackedPoseSensor> sensor;
  std::unique_ptr<rig::Coils> device;
  std::string connected_to;
  std::function<void()> clear_faults;
  std::optional<safety::Supervisor> coils;
  std::unique_ptr<Operator> needle_operator;
};

}  // namespace

void RigSession::place(const geometry::Pose2& pose) {
  parts_.coils->stop();
  parts_.needle_operator->place(pose);
  parts_.sensor->forget();
}

std::unique_ptr<RigSession> make_virtual_session(const rig::VirtualRigConfig& rig,
                                                 const SensingConfig& sensing,
                                                 const safety::SafetyConfig& safety,
                                                 const VirtualSeeds& seeds, bool realtime) {
  const auto made = std::make_shared<VirtualParts>(rig, sensing, safety, seeds, realtime);
  RigSession::Parts parts;
  parts.owner = made;
  parts.coils = &*made->coils;
  parts.sensor = made->sensor.get();
  parts.clock = &made->rig.clock();
  parts.needle_operator = made.get();
  parts.fits = [rig = &made->rig](const geometry::Pose2& pose) { return rig->fits(pose); };
  parts.camera = made->sensor->camera();
  parts.watched = made->sensor->watched();
  parts.truth = made.get();
  return std::make_unique<RigSession>(std::move(parts));
}

std::unique_ptr<RigSession> make_bench_session(const rig::RigConfig& rig, const SensingConfig& sensing,
                                               safety::SafetyConfig safety, AskedOperator::Ask ask,
                                               const std::string& folder) {
  if (safety.stop_file.empty() && !folder.empty()) safety.stop_file = folder + "/STOP";
  const bool at_terminal = ask != nullptr;
  const auto made = std::make_shared<BenchParts>(rig, sensing, safety, std::move(ask));
  RigSession::Parts parts;
  parts.owner = made;
  parts.coils = &*made->coils;
  parts.sensor = &*made->sensor;
  parts.clock = &made->clock;
  parts.needle_operator = made->needle_operator.get();
  parts.fits = [known = physics::RigDescription(rig)](const geometry::Pose2& pose) {
    return known.fits(pose);
  };
  parts.camera = made->by_camera ? &*made->by_camera : nullptr;
  parts.watched = made->watched;
  parts.clear_faults = made->clear_faults;
  if (!folder.empty())
    common::log_info("bench connected on " + made->connected_to + "; Ctrl-C" +
                     (at_terminal ? ", any key" : "") + " or the file " + safety.stop_file + " stops it");
  return std::make_unique<RigSession>(std::move(parts));
}

}  // namespace lodestone::session
