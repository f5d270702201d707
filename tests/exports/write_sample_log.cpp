// usage: write_sample_log FILE [cut]    writes a log of 100 steps; "cut": and is gone in the middle of it.

#include <unistd.h>

#include <string>

#include "lodestone/exports/rig_log.h"

using namespace lodestone;

int main(int argc, char** argv) {
  exports::RigLog log(argv[1], {{"verb", "sample"}, {"config", "{\"seed\": 7}"}});
  const std::uint64_t period_ns = 300'000'000;
  log.event(0, exports::LogLevel::kInfo, "begins");
  for (std::uint64_t i = 0; i < 100; ++i) {
    const auto along = static_cast<double>(i);
    exports::LoggedStep step;
    step.time_ns = i * period_ns;
    step.facts.sensed = i != 50;
    if (step.facts.sensed) step.sensed = geometry::Pose2{1e-3 * along, -2e-3, 0.5};
    step.facts.reason = i == 50 ? "nothing is seen" : "";
    step.truth = geometry::Pose2{1e-3 * along, -2e-3, 0.25};
    step.target = geometry::Pose2{0.01, 0.02, 0.0};
    step.current_A = exports::OfCoils{0.0, 1.5, along, 0.0};
    if (i > 0) {
      exports::CoilReading reading;
      reading.current_A = exports::OfCoils{0.0, 1.4, along - 1.0, 0.0};
      reading.temperature_C = exports::OfCoils{20.0, 21.0, 22.0, 23.0};
      if (i % 2 == 0) reading.supply_V = 48.0;
      if (i == 70) reading.faults = {"over-temperature", "stuck driver"};
      step.reading = reading;
    }
    step.facts.error_m = 0.0;
    log.image(step.time_ns, step.time_ns - i * 1'000, std::string(30'000, static_cast<char>(i)));
    log.step(step);
    if (argc > 2 && i == 60) _exit(9);
  }
  log.event(100 * period_ns, exports::LogLevel::kError, "stopped: too warm");
  log.finish();
}
