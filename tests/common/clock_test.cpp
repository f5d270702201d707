#include "lodestone/common/clock.h"

#include <catch2/catch.hpp>

using namespace lodestone::common;

namespace {

class SimulatedClock final : public Clock {
 public:
  double now_s() const override { return now_s_; }
  bool wait_until(double time_s, Interruption*) override {
    now_s_ = time_s;
    return true;
  }

 private:
  double now_s_ = 500.0;
};

}  // namespace

TEST_CASE("the wall clock goes on, waits no shorter than asked, and not at all for what is past") {
  SteadyClock clock;
  const double start_s = clock.now_s();
  CHECK(clock.wait_until(start_s + 0.02, nullptr));
  CHECK(clock.now_s() >= start_s + 0.02);
  Interruption interruption;
  CHECK(clock.wait_until(start_s, &interruption));
  interruption.raise();
  CHECK_FALSE(clock.wait_until(start_s, &interruption));
  CHECK_FALSE(clock.wait_until(clock.now_s() + 60.0, &interruption));
}

TEST_CASE("the time of the system is that of this century") {
  const double before_s = unix_time_s();
  CHECK(before_s > 1.7e9);
  CHECK(before_s < 4.2e9);
  CHECK(unix_time_s() >= before_s);
}
