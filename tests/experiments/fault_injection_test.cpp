#include "lodestone/experiments/fault_injection.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "soak.h"

using namespace lodestone;

namespace {
std::string scratch() {
  const auto folder =
      std::filesystem::temp_directory_path() / ("lodestone-fault-test-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  return folder.string();
}
}  // namespace

TEST_CASE("every fault leaves the coils off in time, and no record is lost") {
  for (const std::string& fault : experiments::fault_names()) {
    const experiments::FaultResult result = experiments::inject_fault(fault, 1, scratch());
    CAPTURE(fault, result.reason, result.on_after_s, result.pulses, result.asked);
    CHECK_FALSE(result.unsafe);
    CHECK(result.on_after_s <= experiments::kOffWithin_s);
    CHECK_FALSE(result.reason.empty());
    CHECK(result.recorded == result.steps);
  }
}

TEST_CASE("a fault in a pulse that would last for seconds ends it in time") {
  for (const std::string& fault : experiments::device_fault_names()) {
    const experiments::FaultResult result = experiments::inject_held_fault(fault, 1, scratch());
    CAPTURE(fault, result.reason, result.on_after_s);
    CHECK_FALSE(result.unsafe);
    if (result.stopped) CHECK(result.on_after_s > 0.0);
    CHECK(result.on_after_s <= experiments::kOffWithin_s);
  }
}

TEST_CASE("simulated hours with a fault a minute", "[soak]") {
  const tests::Soak soak("pulses of a bench with a fault a minute", 1000, 24000);
  const experiments::HourReport report =
      experiments::inject_for_an_hour(soak.count(), 6 + soak.seed(), scratch());
  for (const experiments::FaultResult& fault : report.faults) {
    CAPTURE(fault.fault, fault.injected_s, fault.reason, fault.on_after_s);
    CHECK_FALSE(fault.unsafe);
    CHECK_FALSE(fault.reason.empty());
  }
  CHECK(report.unsafe == 0);
  CHECK(report.pulses >= soak.count());
  CHECK(static_cast<std::int64_t>(report.faults.size()) >= soak.count() / 220);
  CHECK(report.longest_on_s <= experiments::kOffWithin_s);
}

TEST_CASE("simulated hours with two faults at once every minute", "[soak]") {
  const tests::Soak soak("minutes of a bench with two faults at once in each", 1, 120);
  const experiments::HourReport report =
      experiments::inject_pairs(60.0 * static_cast<double>(soak.count()), soak.seed(), scratch());
  for (const experiments::FaultResult& fault : report.faults) {
    CAPTURE(fault.fault, fault.injected_s, fault.reason, fault.on_after_s);
    CHECK_FALSE(fault.unsafe);
    CHECK_FALSE(fault.reason.empty());
  }
  CHECK(report.unsafe == 0);
  CHECK(static_cast<std::int64_t>(report.faults.size()) >= soak.count());
  CHECK(report.simulated_s >= 60.0 * static_cast<double>(soak.count()));
  CHECK(report.longest_on_s <= experiments::kOffWithin_s);
}
