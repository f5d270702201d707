#include "lodestone/hil/emulated_bench.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/hil/lockstep_port.h"
#include "lodestone/rig/serial_coils.h"
#include "rig/coils_conformance.h"

using namespace lodestone;

namespace {

struct Bench {
  explicit Bench(const rig::VirtualRigConfig& config = {}) : rig(config, 1), bench(rig) {}
  rig::SerialCoils connect(const rig::SerialConfig& config = {}) {
    return {config, [this] { return std::make_unique<hil::LockstepPort>(bench); }};
  }
  rig::VirtualRig rig;
  hil::EmulatedBench bench;
};

}  // namespace

TEST_CASE("the firmware answers, sets the motor controllers up and fires a pulse of the right length") {
  Bench b;
  rig::SerialCoils coils = b.connect();
  CHECK(coils.info().firmware == "1.0.0");
  const double start_s = b.bench.now_s();
  double on_s = 0.0;
  double off_s = 0.0;
  b.bench.watch = [&](double now_s, const std::array<double, 4>& current_A) {
    if (current_A[0] > 2.5 && on_s == 0.0) on_s = now_s;
    if (current_A[0] > 2.5) off_s = now_s;
  };
  coils.apply({{5.0, 0.0, 0.0, -2.0}, 0.1});
  std::printf("ack after %.2f ms\n", 1e3 * (b.bench.now_s() - start_s));
  b.bench.advance_to(start_s + 0.09);
  auto now = b.bench.current_A();
  std::printf("currents %g %g %g %g\n", now[0], now[1], now[2], now[3]);
  b.bench.advance_to(start_s + 0.3);
  std::printf("on %.2f off %.2f length %.2f ms\n", 1e3 * (on_s - start_s), 1e3 * (off_s - start_s), 1e3 * (off_s - on_s));
  auto s = coils.state();
  std::printf("supply %g board %g R %g %g %g %g\n", s.supply_V[0], s.board_C[0], s.resistance_ohm[0], s.resistance_ohm[1], s.resistance_ohm[2], s.resistance_ohm[3]);
  for (auto& f : s.faults) std::printf("fault %s\n", f.c_str());
  for (auto& [t, a] : coils.trace().samples) std::printf("%.4f %.2f\n", t, a);
}
