#include "rig_check.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include "bench_session.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/emulation/live_bench.h"
#include "lodestone/imaging/scene.h"
#include "lodestone/rig/coil_measurement.h"
#include "lodestone/rig/rendered_camera.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/coil_wiring.h"
#include "models.h"

namespace lodestone::apps {
namespace {

constexpr const char* kCoilNames[rig::kCoilCount] = {"+x", "-x", "+y", "-y"};
constexpr double kDegPerRad = 57.29577951308232;

/// The bench, as the verbs around its wiring use it; keys are those of deploy and collect.
struct BenchConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 1;
  double test_current_A = 3.0;
  std::int64_t pulses = 5;
  rig::RigConfig rig;
  safety::SafetyConfig safety;
  session::SensingConfig sensor;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of an emulated bench", {0, 9e15});
    v.field("threads", threads, "", "not used", {0, 1024});
    v.field("test_current_A", test_current_A, "A", "current of the test pulses", {1.0, 10.0});
    v.field("pulses", pulses, "", "pulses per coil of calibrate coils", {1, 100});
    v.group("rig", rig, "the rig");
    v.group("safety", safety, "limits of the supervisor");
    v.group("sensor", sensor, "how poses are sensed");
  }
};

struct CheckOptions {
  CommonOptions common;
  bool yes = false;
  bool clear = false;
  bool no_camera = false;
};

void print_line(const char* what, const std::string& found) {
  std::printf("%-22s %s\n", what, found.c_str());
}

std::string number(double value, const char* unit, int digits = 1) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f %s", digits, value, unit);
  return text;
}

BenchConfig resolve(const CommonOptions& options) {
  auto config = resolve_config<BenchConfig>(options);
  config.safety.max_current_A = std::min(config.safety.max_current_A, config.rig.coils.max_current_A);
  return config;
}

void rest(double seconds) {
  common::SteadyClock clock;
  clock.sleep_until(clock.now_s() + seconds);
}

/// The camera's sensor, where one is wanted.
class PoseProbe {
 public:
  PoseProbe(const BenchConfig& config, bool wanted) {
    if (!wanted) {
      print_line("camera", "not looked at (--no-camera)");
      return;
    }
    camera_ = rig::open_camera(config.rig.camera);
    const imaging::Frame frame = camera_->grab(2.0);
    print_line("camera",
               std::to_string(frame.image.cols) + " x " + std::to_string(frame.image.rows) + " pixels");
    session::SensingConfig sensor = config.sensor;
    choose_segmenter(sensor);
    std::optional<imaging::Calibration> calibration;
    if (!sensor.calibration.empty()) calibration = imaging::read_calibration(sensor.calibration);
    sensor_.emplace(*camera_, vision::Segmenter::load(sensor.segmenter), rig::bench_of(config.rig),
                    sensor.scene.lens, sensor.camera, calibration);
    const control::PoseEstimate seen = sensor_->observe();
    print_line("needle", seen.valid ? "seen at x " + number(1e3 * seen.pose.x_m, "mm") + ", y " +
                                          number(1e3 * seen.pose.y_m, "mm") + ", heading " +
                                          number(seen.pose.heading_rad * kDegPerRad, "degrees", 0)
                                    : "not seen: " + seen.reason);
  }
  /// Null without a camera.
  control::PoseSensor* sensor() { return sensor_ ? &*sensor_ : nullptr; }

 private:
  std::unique_ptr<rig::Camera> camera_;
  std::optional<session::CameraPoseSensor> sensor_;
};

void check_emergency_stop(rig::SerialCoils& coils, bool yes) {
  if (coils.state().emergency_stop)
    throw common::HardwareError(
        "the emergency stop is open: release the switch, or connect pin 22 of the Arduino to "
        "ground through it; then `lodestone rig check --clear`");
  if (yes || !has_operator()) {
    print_line("emergency stop", "closed (press it and look again to test it)");
    return;
  }
  std::printf("%-22s press it now, within 20 s ", "emergency stop");
  std::fflush(stdout);
  for (int i = 0; i < 200 && !coils.state().emergency_stop; ++i) rest(0.1);
  if (!coils.state().emergency_stop)
    throw common::HardwareError(
        "the emergency stop was not seen to open: is it wired to pin 22 of the Arduino?");
  std::printf("- opened; release it ");
  std::fflush(stdout);
  for (int i = 0; i < 600 && coils.state().emergency_stop; ++i) rest(0.1);
  coils.clear_faults();
  std::printf("- works\n");
}

/// Energises one coil. Returns whether its current is as it should be and, without a camera, whether the
/// operator has seen the needle follow.
bool check_coil(const BenchConfig& config, rig::SerialCoils& coils, safety::Supervisor& guarded, int coil,
                bool watched, bool yes) {
  const std::string name = std::string("coil ") + kCoilNames[coil];
  if (!confirm("energise " + name + " with " + number(config.test_current_A, "A") + " for 0.2 s?", yes)) {
    print_line(name.c_str(), "left out");
    return false;
  }
  for (int i = 0; i < 3; ++i) {
    rig::CoilPulse pulse;
    pulse.current_A[static_cast<std::size_t>(coil)] = config.test_current_A;
    pulse.duration_s = 0.2;
    guarded.apply(pulse);
    rest(0.5);
  }
  const rig::CoilControllerState state = coils.state();
  if (!state.faults.empty()) throw common::HardwareError(name + ": " + state.faults.front());
  double largest_A = 0.0;
  for (const auto& sample : coils.trace().samples)
    if (std::abs(sample.second) > std::abs(largest_A)) largest_A = sample.second;
  std::string line = number(largest_A, "A measured", 2) + ", " +
                     number(state.resistance_ohm[static_cast<std::size_t>(coil)], "ohm", 2);
  bool good = std::abs(largest_A - config.test_current_A) < 0.1 * config.test_current_A;
  if (!good) line += " - NOT what was asked";
  if (!watched && has_operator() && !yes &&
      !confirm("did the needle's taped end turn towards coil " + std::string(kCoilNames[coil]) +
                   ", and was the needle drawn towards that coil?",
               false)) {
    line += ", reversed or swapped: see rig.coils.polarity and rig.serial.output, or change the leads";
    good = false;
  }
  print_line(name.c_str(), line);
  return good;
}

/// Finds out by the needle's motion which coil answers to which name. Returns whether all do as they should.
bool check_wiring(const BenchConfig& config, safety::Supervisor& guarded, control::PoseSensor& sensor,
                  bool yes) {
  session::WiringProbe probe;
  probe.current_A = config.test_current_A;
  probe.max_current_A = std::min(probe.max_current_A, config.safety.max_current_A);
  if (!confirm("find out which coil is which, with up to " + std::to_string(probe.max_pulses) +
                   " short pulses of up to " + number(probe.max_current_A, "A") + "?",
               yes)) {
    print_line("wiring", "left out");
    return false;
  }
  session::WiringInference inference(config.rig, session::WiringInference::field_for(config.rig));
  common::SteadyClock clock;
  session::probe_wiring(inference, guarded, sensor, clock, probe);
  const std::vector<session::CoilWiring> possible = inference.possible();
  for (int coil = 0; coil < rig::kCoilCount; ++coil)
    print_line((std::string("asked for ") + kCoilNames[coil]).c_str(),
               inference.moved(coil) == 0
                   ? "the needle did not move: " + session::possible_answers(possible, coil)
                   : session::possible_answers(possible, coil));
  const std::string remedy = session::wiring_remedy(inference, config.rig);
  if (!remedy.empty()) print_line("wiring", remedy);
  return remedy.empty();
}

std::string reset_text(int cause) {
  if ((cause & 8) != 0) return "its watchdog restarted it: please report this";
  if ((cause & 4) != 0) return "its supply sagged (brown-out)";
  return "power or reset";
}

void check(const CheckOptions& options) {
  const BenchConfig config = resolve(options.common);
  std::printf("serial ports:\n");
  for (const rig::SerialPortInfo& port : rig::list_serial_ports())
    std::printf("  %-20s %s\n", port.name.c_str(), port.description.c_str());
  rig::SerialCoils coils(config.rig.serial, config.rig.coils);
  print_line("coil controller", "firmware " + coils.info().firmware + ", protocol " +
                                    std::to_string(coils.info().protocol) + ", started by " +
                                    reset_text(coils.info().reset_cause));
  rig::CoilControllerState state = coils.state();
  for (const std::string& fault : state.faults) print_line("latched fault", fault);
  if (options.clear) {
    coils.clear_faults();
    rest(0.3);
    state = coils.state();
    print_line("cleared", state.faults.empty() ? "no fault is left" : "still there: " + state.faults.front());
  }
  if (!state.faults.empty())
    throw common::HardwareError("rig check: " + state.faults.front() +
                                "; find the cause, then `lodestone rig check --clear`");
  print_line("supply", number(state.supply_V[0], "V") + ", " + number(state.supply_V[1], "V"));
  print_line("motor controllers", number(state.board_C[0], "C") + ", " + number(state.board_C[1], "C"));
  check_emergency_stop(coils, options.yes);
  PoseProbe probe(config, !options.no_camera);
  const common::SteadyClock clock;
  safety::Supervisor guarded(coils, config.safety, config.rig, clock, safety::Supervisor::Poses::kNone);
  control::PoseSensor* const sensor = probe.sensor();
  bool good = true;
  // Each field lies across the one before, so that the needle has to turn.
  for (const int coil : {0, 2, 1, 3})
    good = check_coil(config, coils, guarded, coil, sensor != nullptr, options.yes) && good;
  if (good && sensor != nullptr) good = check_wiring(config, guarded, *sensor, options.yes);
  coils.stop();
  if (!good)
    throw common::HardwareError(
        "rig check: the bench is not ready: something is left out or not as it should be, see above");
  const bool seen = sensor != nullptr || (has_operator() && !options.yes);
  std::printf("%s\n", seen ? "the bench is ready"
                           : "currents are as asked; nobody saw which coil is which, so that is still to be "
                             "checked, with the camera");
}

void calibrate_coils(const CheckOptions& options) {
  const BenchConfig config = resolve(options.common);
  if (options.common.out.empty())
    throw common::ConfigError("calibrate coils: --out FILE.json is missing; name the file to write");
  rig::SerialCoils coils(config.rig.serial, config.rig.coils);
  const common::SteadyClock clock;
  safety::Supervisor guarded(coils, config.safety, config.rig, clock, safety::Supervisor::Poses::kNone);
  common::Json resistance = common::Json::array();
  common::Json inductance = common::Json::array();
  std::printf("%-8s %10s %10s %10s %12s\n", "coil", "R ohm", "L mH", "L/R ms", "residual A");
  for (int coil = 0; coil < rig::kCoilCount; ++coil) {
    if (!confirm(std::string("measure coil ") + kCoilNames[coil] + "? It gets " +
                     std::to_string(config.pulses) + " pulses of " + number(config.test_current_A, "A") + ".",
                 options.yes))
      throw common::Interrupted("calibrate coils: stopped; nothing was written");
    const rig::CoilMeasurement found =
        rig::measure_coil(coils, guarded, coil, config.test_current_A, static_cast<int>(config.pulses), rest);
    std::printf("%-8s %10.3f %10.2f %10.2f %12.3f\n", kCoilNames[coil], found.resistance_ohm,
                1e3 * found.inductance_H(), 1e3 * found.time_constant_s, found.rms_A);
    const double warmer_K = config.rig.ambient_C - 20.0;
    resistance.push_back(found.resistance_ohm /
                         (1.0 + config.rig.coils.temperature_coefficient_per_K * warmer_K));
    inductance.push_back(found.inductance_H());
  }
  coils.stop();
  common::Json rig = common::config_to_json(config.rig);
  rig["coils"]["resistance_20C_ohm"] = resistance;
  rig["coils"]["inductance_H"] = inductance;
  common::write_file_atomically(options.common.out, rig.dump(1) + "\n");
  std::printf(
      "wrote %s: the rig with its coils as measured, for --rig. They counted as %.0f C warm "
      "(rig.ambient_C).\n",
      options.common.out.c_str(), config.rig.ambient_C);
}

void emulate(const CheckOptions& options) {
  const BenchConfig config = resolve(options.common);
  std::shared_ptr<const imaging::SceneRenderer> renderer;
  if (!options.no_camera) {
    imaging::SceneConfig scene = config.sensor.scene;
    scene.bench = rig::bench_of(config.rig);
    renderer = std::make_shared<const imaging::SceneRenderer>(
        imaging::draw_scene(scene, static_cast<std::uint64_t>(config.seed)));
  }
  emulation::LiveBench bench(config.rig, static_cast<std::uint64_t>(config.seed), renderer);
  rig::RigConfig rig = config.rig;
  rig.backend = rig::Backend::kSerial;
  rig.serial.port = bench.port();
  if (renderer) {
    rig.camera.kind = rig::CameraKind::kGenicam;
    rig.camera.source = bench.camera();
    rig.camera.serial = bench.camera_serial();
    rig.camera.pixel_format = "RGB8";
    rig.camera.width_px = renderer->scene().camera.width_px;
    rig.camera.height_px = renderer->scene().camera.height_px;
    rig.camera.frame_rate_hz = 20.0;
  }
  const std::string json = common::config_to_json(rig).dump(1);
  std::printf(
      "emulated rig on %s: give this rig.json to deploy, collect, rig check or calibrate coils by "
      "--rig\n%s\n",
      bench.port().c_str(), json.c_str());
  std::fflush(stdout);
  if (!options.common.out.empty()) common::write_file_atomically(options.common.out, json + "\n");
  common::log_info("it runs until Ctrl-C");
  while (!common::interrupted()) rest(0.1);
  if (bench.lost_s() > 0.5)
    common::log_warning("this machine was too slow for real time for " + number(bench.lost_s(), "s"));
}

void add_bench_options(CLI::App& verb, CheckOptions& options, bool asks) {
  add_common_options(verb, options.common);
  add_shorthand(verb, options.common, "--port", "rig.serial.port", Shorthand::kText,
                "serial port of the coil controller, such as /dev/ttyACM0");
  if (asks) verb.add_flag("--yes", options.yes, "answer every question with yes: coils will be energised");
}

}  // namespace

void add_rig_check(CLI::App& rig, ConfigCatalogue& catalogue) {
  CLI::App* verb = rig.add_subcommand(
      "check", "walk through the wiring: port, firmware, supply, emergency stop, camera, each coil");
  auto options = std::make_shared<CheckOptions>();
  catalogue["rig check"] = [options] { return describe_resolved<BenchConfig>(options->common); };
  add_bench_options(*verb, *options, true);
  verb->add_flag("--clear", options->clear, "forget the faults that the coil controller has latched");
  verb->add_flag("--no-camera", options->no_camera, "leave the camera out");
  verb->callback([options] { check(*options); });
}

void add_rig_emulate(CLI::App& rig, ConfigCatalogue& catalogue) {
  CLI::App* verb = rig.add_subcommand(
      "emulate", "run a bench without hardware: the real firmware, its serial port, a GigE Vision camera");
  auto options = std::make_shared<CheckOptions>();
  catalogue["rig emulate"] = [options] { return describe_resolved<BenchConfig>(options->common); };
  add_bench_options(*verb, *options, false);
  add_virtual_rig_options(*verb, options->common, "seed");
  verb->add_flag("--no-camera", options->no_camera, "without a camera");
  verb->callback([options] { emulate(*options); });
}

void add_calibrate_coils(CLI::App& calibrate, ConfigCatalogue& catalogue) {
  CLI::App* verb =
      calibrate.add_subcommand("coils", "measure resistance and inductance of the coils of a real bench");
  auto options = std::make_shared<CheckOptions>();
  catalogue["calibrate coils"] = [options] { return describe_resolved<BenchConfig>(options->common); };
  add_bench_options(*verb, *options, true);
  verb->callback([options] { calibrate_coils(*options); });
}

}  // namespace lodestone::apps
