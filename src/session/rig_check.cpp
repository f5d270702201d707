#include "lodestone/session/rig_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/rig/serial_coils.h"
#include "lodestone/safety/check.h"
#include "lodestone/session/coil_wiring.h"

namespace lodestone::session {

namespace {

constexpr int kNameWidth = 22;

std::string number(double value, const char* unit, int digits = 1) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f %s", digits, value, unit);
  return text;
}

std::string numbers(const std::vector<double>& values, const char* unit) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + number(value, unit);
  return text;
}

std::string named(std::string what) {
  what.resize(std::max<std::size_t>(what.size(), kNameWidth), ' ');
  return what + " ";
}

void rest(double seconds) {
  common::SteadyClock clock;
  clock.sleep_until(clock.now_s() + seconds);
}

std::string reset_text(int cause) {
  if ((cause & 8) != 0) return "its watchdog restarted it: please report this";
  if ((cause & 4) != 0) return "its supply sagged (brown-out)";
  return "power or reset";
}

/// The camera and what it sees.
struct Watcher {
  explicit Watcher(const RigCheckConfig& config) : camera(rig::open_camera(config.rig.camera)) {
    const imaging::Frame frame = camera->grab(2.0);
    size = std::to_string(frame.image.cols) + " x " + std::to_string(frame.image.rows) + " pixels";
    std::optional<imaging::Calibration> calibration;
    if (!config.sensor.calibration.empty())
      calibration = imaging::read_calibration(config.sensor.calibration);
    detector.emplace(*camera, vision::Segmenter::load(config.sensor.segmenter), config.rig,
                     config.sensor.scene.lens, config.sensor.camera, calibration);
    sensor.emplace(*detector, config.sensor.tracker, config.rig, clock);
  }
  std::unique_ptr<rig::Camera> camera;
  std::string size;
  common::SteadyClock clock;
  std::optional<CameraDetector> detector;
  std::optional<TrackedPoseSensor> sensor;
};

class Walk {
 public:
  Walk(const RigCheckConfig& config, Dialogue& dialogue)
      : config_(config),
        dialogue_(dialogue),
        coils_(config.rig.serial, config.rig.coils),
        guarded_(coils_, config.safety, config.rig, clock_, safety::Supervisor::Poses::kNone) {}

  void run(const RigCheckRequest& request) {
    look_at_controller(request.clear);
    check_emergency_stop();
    if (request.camera)
      open_camera();
    else
      tell("camera", "not looked at (--no-camera)");
    bool good = true;
    for (const int coil : crossing_order(config_.rig)) good = check_coil(coil) && good;
    if (good && watcher_) good = check_wiring();
    coils_.stop();
    if (!good)
      throw common::HardwareError(
          "rig check: the bench is not ready: something is left out or not as it should be, see above");
    const bool seen = watcher_ || dialogue_.attended();
    dialogue_.say(seen ? "the bench is ready\n"
                       : "currents are as asked; nobody saw which coil is which, so that is still to be "
                         "checked, with the camera\n");
  }

 private:
  void tell(const std::string& what, const std::string& found) { dialogue_.say(named(what) + found + "\n"); }

  void look_at_controller(bool clear) {
    const auto& info = coils_.info();
    tell("coil controller", "firmware " + info.firmware + ", protocol " + std::to_string(info.protocol) +
                                ", started by " + reset_text(info.reset_cause));
    rig::CoilControllerState state = coils_.state();
    for (const std::string& fault : state.faults) tell("latched fault", fault);
    if (clear) {
      coils_.clear_faults();
      rest(0.3);
      state = coils_.state();
      tell("cleared", state.faults.empty() ? "no fault is left" : "still there: " + state.faults.front());
    }
    if (!state.faults.empty())
      throw common::HardwareError("rig check: " + state.faults.front() +
                                  "; find the cause, then `lodestone rig check --clear`");
    tell("supply", numbers(state.supply_V, "V"));
    tell("motor controllers", numbers(state.board_C, "C"));
  }

  void check_emergency_stop() {
    const auto wait_until_it_is = [this](bool open, int tenths_s) {
      for (int i = 0; i < tenths_s && coils_.state().emergency_stop != open; ++i) rest(0.1);
    };
    if (coils_.state().emergency_stop)
      throw common::HardwareError(
          "the emergency stop is open: release the switch, or connect pin 22 of the Arduino to "
          "ground through it; then `lodestone rig check --clear`");
    if (!dialogue_.attended()) return tell("emergency stop", "closed (press it and look again to test it)");
    dialogue_.say(named("emergency stop") + "press it now, within 20 s ");
    wait_until_it_is(true, 200);
    if (!coils_.state().emergency_stop)
      throw common::HardwareError(
          "the emergency stop was not seen to open: is it wired to pin 22 of the Arduino?");
    dialogue_.say("- opened; release it ");
    wait_until_it_is(false, 600);
    coils_.clear_faults();
    dialogue_.say("- works\n");
  }

  void open_camera() {
    watcher_.emplace(config_);
    tell("camera", watcher_->size);
    const control::PoseEstimate seen = watcher_->sensor->observe();
    tell("needle", seen.valid ? "seen at x " + number(1e3 * seen.pose.x_m, "mm") + ", y " +
                                    number(1e3 * seen.pose.y_m, "mm") + ", heading " +
                                    number(seen.pose.heading_rad * geometry::kDegPerRad, "degrees", 0)
                              : "not seen: " + seen.reason);
  }

  /// Energises one coil. Returns whether its current is as it should be and, without a camera, whether the
  /// person there has seen the needle follow.
  bool check_coil(int coil) {
    const auto index = static_cast<std::size_t>(coil);
    const std::string name = "coil " + config_.rig.coils.name(index);
    const double test_current_A = std::min(config_.test_current_A, config_.rig.coils.largest_A(index));
    if (!dialogue_.confirm("energise " + name + " with " + number(test_current_A, "A") + " for 0.2 s?")) {
      tell(name, "left out");
      return false;
    }
    for (int i = 0; i < 3; ++i) {
      rig::CoilPulse pulse;
      pulse.current_A[index] = test_current_A;
      pulse.duration_s = 0.2;
      guarded_.apply(pulse);
      rest(0.5);
    }
    const rig::CoilControllerState state = coils_.state();
    if (!state.faults.empty()) throw common::HardwareError(name + ": " + state.faults.front());
    double largest_A = 0.0;
    for (const auto& sample : coils_.trace().samples)
      if (std::abs(sample.second) > std::abs(largest_A)) largest_A = sample.second;
    std::string line =
        number(largest_A, "A measured", 2) + ", " + number(state.resistance_ohm[index], "ohm", 2);
    bool good = std::abs(largest_A - test_current_A) < 0.1 * test_current_A;
    if (!good) line += " - NOT what was asked";
    if (!watcher_ && dialogue_.attended() &&
        !dialogue_.confirm("did the needle's taped end turn towards " + name +
                           ", and was the needle drawn towards that coil?")) {
      line += ", reversed or swapped: see rig.coils.polarity and rig.serial.output, or change the leads";
      good = false;
    }
    tell(name, line);
    return good;
  }

  /// Finds out by the needle's motion which coil answers to which name. Returns whether all do as they
  /// should.
  bool check_wiring() {
    const int coils = static_cast<int>(config_.rig.coils.count());
    WiringProbe probe;
    probe.max_current_A = std::min(probe.max_current_A, config_.safety.max_current_A);
    for (int coil = 0; coil < coils; ++coil)  // any of them may be the one that answers
      probe.max_current_A =
          std::min(probe.max_current_A, config_.rig.coils.largest_A(static_cast<std::size_t>(coil)));
    probe.current_A = std::min(config_.test_current_A, probe.max_current_A);
    if (!dialogue_.confirm("find out which coil is which, with up to " +
                           std::to_string(probe.max_pulses_each * coils) + " short pulses of up to " +
                           number(probe.max_current_A, "A") + "?")) {
      tell("wiring", "left out");
      return false;
    }
    WiringInference inference(config_.rig, WiringInference::field_for(config_.rig));
    probe_wiring(inference, guarded_, *watcher_->sensor, clock_, probe);
    const PossibleWirings possible = inference.possible();
    for (int coil = 0; coil < coils; ++coil)
      tell("asked for " + config_.rig.coils.name(static_cast<std::size_t>(coil)),
           (inference.moved(coil) == 0 ? "the needle did not move: " : "") +
               possible_answers(possible, coil, config_.rig.coils));
    const std::string remedy = wiring_remedy(inference, config_.rig);
    if (!remedy.empty()) tell("wiring", remedy);
    return remedy.empty();
  }

  const RigCheckConfig& config_;
  Dialogue& dialogue_;
  common::SteadyClock clock_;
  rig::SerialCoils coils_;
  safety::Supervisor guarded_;
  std::optional<Watcher> watcher_;
};

}  // namespace

void check_rig(const RigCheckConfig& config, const RigCheckRequest& request, Dialogue& dialogue) {
  if (config.rig.backend == rig::Backend::kDriver)
    throw common::ConfigError(
        "rig.backend = driver: the walk through the wiring is for the coil controller on a serial port; "
        "`lodestone rig conform` tests a driver");
  if (config.rig.needle.is_sphere())
    throw common::ConfigError(
        "rig.needle.shape = sphere: which coil answers to which name, and which way round, is told by how a "
        "needle turns; put one into the dish for this walk, and say so (rig.needle)");
  dialogue.say("serial ports:\n");
  for (const rig::SerialPortInfo& port : rig::list_serial_ports()) {
    char line[256];
    std::snprintf(line, sizeof line, "  %-20s %s\n", port.name.c_str(), port.description.c_str());
    dialogue.say(line);
  }
  Walk(config, dialogue).run(request);
}

}  // namespace lodestone::session
