#include "lodestone/common/clock.h"

#include <chrono>
#include <thread>

namespace lodestone::common {

double SteadyClock::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void SteadyClock::sleep_until(double time_s) {
  const double wait_s = time_s - now_s();
  if (wait_s > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
}

PacedClock::PacedClock(Clock& simulated)
    : simulated_(simulated), offset_s_(wall_.now_s() - simulated.now_s()) {}

double PacedClock::now_s() const { return simulated_.now_s(); }

void PacedClock::sleep_until(double time_s) {
  simulated_.sleep_until(time_s);
  wall_.sleep_until(time_s + offset_s_);
}

}  // namespace lodestone::common
