#include <catch2/catch.hpp>

#include "../../src/report/sections.h"
#include "report/small_run.h"

using namespace lodestone::report;
using lodestone::tests::holds;

TEST_CASE("trials are shown over time, by their errors, at their worst, and with their coils") {
  lodestone::report::RunData run = lodestone::tests::small_run();
  const std::string html = trials_section(run);
  CHECK(holds(html, "id=\"over-time-point\""));
  CHECK(holds(html, "id=\"distribution-point\""));
  CHECK(holds(html, "The worst trial of point: 7.1 mm"));
  CHECK(holds(html, "largest current was 12.0 A, the hottest coil 31.2 °C"));
  CHECK(holds(html, "Temperatures the coils report"));
  CHECK(holds(html, "id=\"drive-gain\""));
  CHECK(holds(html, "What the pulses said about the rig"));
}

TEST_CASE("a run without a record of its currents says so, one without trials, too") {
  lodestone::report::RunData run = lodestone::tests::small_run();
  for (auto& trial : *run.rigs.front().trials) trial.log_drive_gain.reset();
  CHECK_FALSE(holds(trials_section(run), "drive-gain"));
  for (auto& trial : *run.rigs.front().trials) trial.current_A.reset();
  CHECK(holds(trials_section(run), "A record of currents"));
  CHECK_FALSE(holds(trials_section(run), "largest current"));
  run.rigs.front().trials.reset();
  CHECK(holds(trials_section(run), "The list of trials"));
}
