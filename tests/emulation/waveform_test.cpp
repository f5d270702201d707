// What simulated coils make of a pulse when they are driven as configs/rigs/coil_controller.json says, beside
// the firmware with its motor controllers.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/emulation/lockstep_port.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/rig/serial_coils.h"
#include "rig/described_rig.h"

using namespace lodestone;

namespace {

constexpr double kBefore_s = 0.3;  // at rest
constexpr double kAfter_s = 0.5;   // from the pulse's beginning

/// The preset, exactly as it is described.
rig::VirtualRigConfig driven_as_by_firmware() {
  const std::string file = LODESTONE_SOURCE_DIR "/configs/rigs/coil_controller.json";
  rig::VirtualRigConfig config = common::config_from_json<rig::RigConfig>(common::read_json_file(file), file);
  config.simulation.deviation = rig::DeviationWidth::kNone;
  return config;
}

/// What came of a pulse.
struct PulseTrace {
  std::vector<std::pair<double, physics::PerCoil>> samples;  // s, A
  double moved_m = 0.0;

  void add(double time_s, const physics::PerCoil& current_A) { samples.emplace_back(time_s, current_A); }
  double charge_As(std::size_t coil) const {
    double sum_As = 0.0;
    for (std::size_t i = 1; i < samples.size(); ++i)
      sum_As += 0.5 * (samples[i].second[coil] + samples[i - 1].second[coil]) *
                (samples[i].first - samples[i - 1].first);
    return sum_As;
  }
  /// When a current is first as large.
  double reaches_s(std::size_t coil, double current_A) const {
    for (const auto& [time_s, all_A] : samples)
      if (std::abs(all_A[coil]) >= current_A) return time_s;
    return NAN;
  }
  double rise_s(std::size_t coil, double current_A) const {
    return reaches_s(coil, current_A) - reaches_s(coil, 0.1);
  }
};

const geometry::Pose2 kTracedFrom = {-0.004, 0.003, 0.4};

double moved_from_start_m(const rig::VirtualRig& rig) {
  return (rig.true_pose().position_m() - kTracedFrom.position_m()).norm();
}

PulseTrace through_firmware(const rig::VirtualRigConfig& config, const rig::CoilPulse& pulse) {
  rig::VirtualRig rig(config, 1);
  emulation::EmulatedBench bench(rig);
  rig::SerialConfig serial;
  rig::SerialCoils coils(serial, config.coils,
                         [&bench] { return std::make_unique<emulation::LockstepPort>(bench); });
  bench.advance_to(bench.now_s() + kBefore_s);
  rig.place(kTracedFrom);
  PulseTrace trace;
  bench.watch = [&trace](double now_s, const physics::PerCoil& current_A) { trace.add(now_s, current_A); };
  const double end_s = bench.now_s() + kAfter_s;
  coils.apply(pulse);
  bench.advance_to(end_s);
  bench.watch = nullptr;
  trace.moved_m = moved_from_start_m(rig);
  return trace;
}

PulseTrace by_simulated_coils(const rig::VirtualRigConfig& config, const rig::CoilPulse& pulse) {
  rig::VirtualRig rig(config, 1);
  rig.clock().sleep_until(kBefore_s);
  rig.place(kTracedFrom);
  rig.coils().apply(pulse);
  PulseTrace trace;
  for (int step = 1; step <= 5000; ++step) {
    rig.clock().sleep_until(kBefore_s + 1e-4 * step);
    trace.add(rig.clock().now_s(), rig.coils().status().current_A);
  }
  trace.moved_m = moved_from_start_m(rig);
  return trace;
}

}  // namespace

TEST_CASE("simulated coils rise, give charge and move the needle as those behind the firmware") {
  const rig::VirtualRigConfig config = driven_as_by_firmware();
  rig::VirtualRigConfig at_once = config;
  at_once.amplifier = physics::AmplifierConfig{};
  SECTION("one strong coil") {
    const rig::CoilPulse pulse{{0.0, 0.0, 10.0, 0.0}, 0.1};
    const PulseTrace emulated = through_firmware(config, pulse);
    const PulseTrace simulated = by_simulated_coils(config, pulse);
    CHECK(simulated.charge_As(2) == Approx(emulated.charge_As(2)).epsilon(0.04));
    CHECK(simulated.rise_s(2, 9.0) == Approx(emulated.rise_s(2, 9.0)).margin(1e-3));
    CHECK(by_simulated_coils(at_once, pulse).rise_s(2, 9.0) < emulated.rise_s(2, 9.0) - 5e-3);
  }
  SECTION("a coil of each axis") {
    const rig::CoilPulse pulse{{5.0, 0.0, 0.0, 5.0}, 0.1};
    const PulseTrace emulated = through_firmware(config, pulse);
    const PulseTrace simulated = by_simulated_coils(config, pulse);
    for (const std::size_t coil : {std::size_t{0}, std::size_t{3}})
      CHECK(simulated.charge_As(coil) == Approx(emulated.charge_As(coil)).epsilon(0.04));
    const auto skew_s = [](const PulseTrace& trace) {
      return trace.reaches_s(3, 0.1) - trace.reaches_s(0, 0.1);
    };
    CHECK(skew_s(emulated) > 0.3e-3);
    CHECK(skew_s(simulated) == Approx(skew_s(emulated)).margin(0.3e-3));
    CHECK(emulated.moved_m > 2e-3);
    CHECK(simulated.moved_m == Approx(emulated.moved_m).epsilon(0.1));
  }
}

TEST_CASE("a weak supply sags for simulated coils and for the motor controllers alike") {
  rig::VirtualRigConfig config = driven_as_by_firmware();
  config.supply_resistance_ohm = 0.3;
  const rig::CoilPulse pulse{{10.0, 0.0, 0.0, 0.0}, 0.3};
  const PulseTrace emulated = through_firmware(config, pulse);
  const PulseTrace simulated = by_simulated_coils(config, pulse);
  CHECK(simulated.charge_As(0) == Approx(emulated.charge_As(0)).epsilon(0.04));

  rig::VirtualRig rig(config, 1);
  emulation::EmulatedBench bench(rig);
  rig::SerialConfig serial;
  rig::SerialCoils coils(serial, config.coils,
                         [&bench] { return std::make_unique<emulation::LockstepPort>(bench); });
  coils.apply(pulse);
  bench.advance_to(bench.now_s() + 0.25);
  CHECK(bench.controller(0).supply_V == Approx(34.0 - 0.3 * bench.current_A()[0]).epsilon(0.01));
  CHECK(coils.state().supply_V[0] == Approx(31.0).margin(0.6));
  CHECK(bench.current_A()[0] == Approx(10.0).epsilon(0.03));  // the supply was measured, and made up for
}

TEST_CASE("the emulated motor controllers give duties, and say so where a rig's drivers do not") {
  rig::VirtualRigConfig config = tests::described_rig();
  config.amplifier.controls = physics::AmplifierControl::kCurrent;
  rig::VirtualRig rig(config, 1);
  CHECK_THROWS_WITH(emulation::EmulatedBench(rig), Catch::Contains("rig.amplifier.controls = current"));
}
