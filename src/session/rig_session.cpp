#include "lodestone/session/rig_session.h"

#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/imaging/calibration.h"
#include "lodestone/rig/serial_coils.h"

namespace lodestone::session {

namespace {

class VirtualSession final : public RigSession {
 public:
  VirtualSession(const rig::VirtualRigConfig& rig, const SensingConfig& sensing,
                 const safety::SafetyConfig& safety, const VirtualSeeds& seeds, bool realtime)
      : rig_(rig, seeds.rig), sensing_(sensing, rig) {
    if (seeds.scatter) {
      common::Json state = rig_.save();
      state["scatter"] = seeds.scatter->save();
      rig_.restore(state);
    }
    sensor_ = sensing_.make(rig_, sensing_.calibrated_bench(seeds.scene), seeds.sensor_noise);
    if (realtime) paced_.emplace(rig_.clock());
    coils_.emplace(rig_.coils(), safety, rig, clock());
  }
  safety::Supervisor& coils() override { return *coils_; }
  control::PoseSensor& sensor() override { return *sensor_; }
  common::Clock& clock() override { return paced_ ? static_cast<common::Clock&>(*paced_) : rig_.clock(); }
  bool fits(const geometry::Pose2& pose) const override { return rig_.fits(pose); }
  void place(const geometry::Pose2& pose) override {
    rig_.place(pose);
    sensor_->reset();
  }
  const CameraPoseSensor* camera() const override { return sensor_->camera(); }
  std::optional<geometry::Pose2> true_pose() const override { return rig_.true_pose(); }
  common::Json save() const override { return {{"rig", rig_.save()}, {"sensor", sensor_->save()}}; }
  void restore(const common::Json& state) override {
    rig_.restore(state.at("rig"));
    sensor_->restore(state.at("sensor").get<std::string>());
  }

 private:
  rig::VirtualRig rig_;
  Sensing sensing_;
  std::unique_ptr<RigSensor> sensor_;
  std::optional<common::PacedClock> paced_;
  std::optional<safety::Supervisor> coils_;
};

class SerialSession final : public RigSession {
 public:
  SerialSession(const rig::RigConfig& rig, const SensingConfig& sensing, const safety::SafetyConfig& safety,
                AskOperator ask)
      : rig_(rig), ask_(std::move(ask)) {
    if (sensing.kind != "camera")
      throw common::ConfigError("sensor.kind = \"" + sensing.kind +
                                "\": only a camera can see the needle of a real bench; use \"camera\"");
    const auto segmenter = vision::Segmenter::load(sensing.segmenter);
    std::optional<imaging::Calibration> calibration;
    if (!sensing.calibration.empty()) calibration = imaging::read_calibration(sensing.calibration);
    camera_ = rig::open_camera(rig.camera);
    sensor_.emplace(*camera_, segmenter, rig::bench_of(rig), sensing.scene.lens, sensing.camera, calibration);
    device_ = std::make_unique<rig::SerialCoils>(rig.serial, rig.coils);
    coils_.emplace(*device_, safety, rig_, clock_, safety::Supervisor::Poses::kRequired, true);
  }
  safety::Supervisor& coils() override { return *coils_; }
  control::PoseSensor& sensor() override { return *sensor_; }
  common::Clock& clock() override { return clock_; }
  bool fits(const geometry::Pose2& pose) const override { return rig_.fits(pose); }
  void place(const geometry::Pose2& pose) override {
    if (!ask_)
      throw common::HardwareError(
          "the needle has to be placed elsewhere and nobody can be asked: run this in a terminal");
    coils_->stop();
    ask_(pose);
    sensor_->reset();
  }
  const CameraPoseSensor* camera() const override { return &*sensor_; }
  std::optional<geometry::Pose2> true_pose() const override { return std::nullopt; }
  common::Json save() const override { return nullptr; }
  void restore(const common::Json&) override {}

 private:
  rig::RigConfig rig_;
  AskOperator ask_;
  common::SteadyClock clock_;
  std::unique_ptr<rig::Camera> camera_;
  std::optional<CameraPoseSensor> sensor_;
  std::unique_ptr<rig::SerialCoils> device_;
  std::optional<safety::Supervisor> coils_;
};

}  // namespace

std::unique_ptr<RigSession> make_virtual_session(const rig::VirtualRigConfig& rig,
                                                 const SensingConfig& sensing,
                                                 const safety::SafetyConfig& safety,
                                                 const VirtualSeeds& seeds, bool realtime) {
  return std::make_unique<VirtualSession>(rig, sensing, safety, seeds, realtime);
}

std::unique_ptr<RigSession> make_serial_session(const rig::RigConfig& rig, const SensingConfig& sensing,
                                                const safety::SafetyConfig& safety, AskOperator ask) {
  return std::make_unique<SerialSession>(rig, sensing, safety, std::move(ask));
}

}  // namespace lodestone::session
