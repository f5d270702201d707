#include "lodestone/common/clock.h"

#include <chrono>
#include <thread>

namespace lodestone::common {

double SteadyClock::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool SteadyClock::wait_until(double time_s, Interruption* interruption) {
  const double wait_s = time_s - now_s();
  if (interruption != nullptr) return wait_s > 0.0 ? interruption->wait_for(wait_s) : !interruption->raised();
  if (wait_s > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
  return true;
}

double unix_time_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace lodestone::common
