#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "common_options.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/experiments/emulated_rig.h"
#include "lodestone/rig/coil_measurement.h"
#include "lodestone/rig/driver_stream.h"
#include "lodestone/rig/serial_coils.h"
#include "lodestone/safety/check.h"
#include "lodestone/session/driver_conformance.h"
#include "lodestone/session/rig_check.h"
#include "models.h"
#include "terminal.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct BenchOptions : CommonOptions {
  bool yes = false;
  bool clear = false;
  bool no_camera = false;
};

session::RigCheckConfig resolve(const CommonOptions& options) {
  auto config = resolve_config<session::RigCheckConfig>(options);
  config.safety.max_current_A = std::min(config.safety.max_current_A, config.rig.coils.max_current_A);
  return config;
}

void rest(double seconds) {
  common::SteadyClock clock;
  clock.sleep_until(clock.now_s() + seconds);
}

std::string number(double value, const char* unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.1f %s", value, unit);
  return text;
}

void check(const BenchOptions& options) {
  session::RigCheckConfig config = resolve(options);
  if (!options.no_camera) choose_segmenter(config.sensor);
  TerminalDialogue dialogue(options.yes);
  session::check_rig(config, {!options.no_camera, options.clear}, dialogue);
}

void calibrate_coils(const BenchOptions& options) {
  const session::RigCheckConfig config = resolve(options);
  if (options.out.empty())
    throw common::ConfigError("calibrate coils: --out FILE.json is missing; name the file to write");
  if (config.rig.backend == rig::Backend::kDriver)
    throw common::ConfigError(
        "rig.backend = driver: calibrate coils measures those of the coil controller on a serial port");
  rig::SerialCoils coils(config.rig.serial, config.rig.coils);
  const common::SteadyClock clock;
  safety::Supervisor guarded(coils, config.safety, config.rig, clock, safety::Supervisor::Poses::kNone);
  common::Json resistance = common::Json::array();
  common::Json inductance = common::Json::array();
  std::printf("%-8s %10s %10s %10s %12s\n", "coil", "R ohm", "L mH", "L/R ms", "residual A");
  for (std::size_t coil = 0; coil < config.rig.coils.count(); ++coil) {
    const std::string name = config.rig.coils.name(coil);
    const double test_current_A = std::min(config.test_current_A, config.rig.coils.largest_A(coil));
    if (!confirm("measure coil " + name + "? It gets " + std::to_string(config.pulses) + " pulses of " +
                     number(test_current_A, "A") + ".",
                 options.yes))
      throw common::Interrupted("calibrate coils: stopped; nothing was written");
    const rig::CoilMeasurement found = rig::measure_coil(
        coils, guarded, static_cast<int>(coil), test_current_A, static_cast<int>(config.pulses), rest);
    std::printf("%-8s %10.3f %10.2f %10.2f %12.3f\n", name.c_str(), found.resistance_ohm,
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
  common::write_file_atomically(options.out, rig.dump(1) + "\n");
  std::printf(
      "wrote %s: the rig with its coils as measured, for --rig. They counted as %.0f C warm "
      "(rig.ambient_C).\n",
      options.out.c_str(), config.rig.ambient_C);
}

void emulate(const BenchOptions& options) {
  const session::RigCheckConfig config = resolve(options);
  const auto seed = static_cast<std::uint64_t>(config.seed);
  const experiments::EmulatedRig emulated = experiments::make_emulated_rig(
      config.rig, seed, options.no_camera ? nullptr : &config.sensor.scene, seed);
  const std::string json = common::config_to_json(emulated.description).dump(1);
  std::printf(
      "emulated rig on %s: give this rig.json to deploy, collect, rig check or calibrate coils by "
      "--rig\n%s\n",
      emulated.description.serial.port.c_str(), json.c_str());
  std::fflush(stdout);
  if (!options.out.empty()) common::write_file_atomically(options.out, json + "\n");
  common::log_info("it runs until Ctrl-C");
  while (!common::interrupted()) rest(0.1);
  if (const double lost_s = emulated.bench->lost_s(); lost_s > 0.5)
    common::log_warning("this machine was too slow for real time for " + number(lost_s, "s"));
}

void show(const std::string& driver, const std::vector<session::ConformanceItem>& items, int& failed) {
  std::printf("%s\n", driver.c_str());
  for (const session::ConformanceItem& item : items) {
    std::printf("  %-8s %s: %s\n", item.passed ? "ok" : "FAILED", item.what.c_str(), item.seen.c_str());
    failed += item.passed ? 0 : 1;
  }
}

void conform(const BenchOptions& options) {
  const session::RigCheckConfig config = resolve(options);
  const rig::DriverConfig& driver = config.rig.driver;
  const bool camera = config.rig.camera.kind == rig::CameraKind::kDriver;
  if (driver.coils.empty() && driver.sensor.empty() && !camera)
    throw common::ConfigError(
        "rig conform: this rig has no driver; name one as rig.driver.coils, rig.driver.sensor or "
        "rig.camera.source (docs/driver-protocol.md)");
  const auto opener = [&](const std::string& address, const std::string& key) {
    return [=, start_s = driver.start_timeout_s] { return rig::open_driver_stream(address, start_s, key); };
  };
  int failed = 0;
  if (!driver.coils.empty()) {
    const std::string most =
        number(config.safety.max_current_A < config.test_current_A ? config.safety.max_current_A
                                                                   : config.test_current_A,
               "A");
    if (!confirm("test " + driver.coils + "? Each coil gets up to " + most +
                     " for some tenths of a second, and is asked for more than it may have, which has to be "
                     "refused.",
                 options.yes))
      throw common::Interrupted("rig conform: stopped; nothing was tested");
    show(driver.coils,
         session::check_coils_driver(opener(driver.coils, "rig.driver.coils"), driver, config.rig.coils,
                                     std::min(config.test_current_A, config.safety.max_current_A)),
         failed);
  }
  if (!driver.sensor.empty())
    show(driver.sensor,
         session::check_sensor_driver(opener(driver.sensor, "rig.driver.sensor"), driver, config.rig.needle),
         failed);
  if (camera)
    show(config.rig.camera.source,
         session::check_camera_driver(opener(config.rig.camera.source, "rig.camera.source"), driver,
                                      config.sensor.camera.timeout_s),
         failed);
  if (failed > 0)
    throw common::HardwareError("rig conform: " + std::to_string(failed) +
                                (failed == 1 ? " test" : " tests") +
                                " failed; docs/driver-protocol.md says what a driver has to do");
  std::printf("the driver keeps the protocol\n");
}

void add_bench_options(Verb& verb, BenchOptions& options, bool asks) {
  add_common_options(verb, options);
  add_shorthand(verb, options, "--port", "rig.serial.port", Shorthand::kText,
                "serial port of the coil controller, such as /dev/ttyACM0");
  if (asks) verb.add_option("--yes", &options.yes, "answer every question with yes: coils will be energised");
}

}  // namespace

void add_rig_check(Verb& rig) {
  Verb& verb = rig.add_verb(
      "check", "walk through the wiring: port, firmware, supply, emergency stop, camera, each coil");
  auto& options = configure<session::RigCheckConfig>(verb, check);
  add_bench_options(verb, options, true);
  verb.add_option("--clear", &options.clear, "forget the faults that the coil controller has latched");
  verb.add_option("--no-camera", &options.no_camera, "leave the camera out");
}

void add_rig_emulate(Verb& rig) {
  Verb& verb = rig.add_verb(
      "emulate", "run a bench without hardware: the real firmware, its serial port, a GigE Vision camera");
  auto& options = configure<session::RigCheckConfig>(verb, emulate);
  add_bench_options(verb, options, false);
  add_virtual_rig_options(verb, options, "seed");
  verb.add_option("--no-camera", &options.no_camera, "without a camera");
}

void add_rig_conform(Verb& rig) {
  Verb& verb =
      rig.add_verb("conform", "test drivers of your own (rig.driver, rig.camera) against their protocol");
  auto& options = configure<session::RigCheckConfig>(verb, conform);
  add_common_options(verb, options);
  verb.add_option("--yes", &options.yes, "answer every question with yes: coils will be energised");
}

void add_calibrate_coils(Verb& calibrate) {
  Verb& verb = calibrate.add_verb("coils", "measure resistance and inductance of the coils of a real bench");
  add_bench_options(verb, configure<session::RigCheckConfig>(verb, calibrate_coils), true);
}

}  // namespace lodestone::apps
