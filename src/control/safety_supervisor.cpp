#include "lodestone/control/safety_supervisor.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>

#include "lodestone/common/error.h"

namespace lodestone::control {

namespace {
constexpr const char* kCoilNames[rig::kCoilCount] = {"+x", "-x", "+y", "-y"};

template <class... Parts>
std::string line(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}
}  // namespace

void SafetySupervisor::latch(const std::string& reason) {
  coils_.stop();
  reason_ = reason;
  throw common::HardwareError("safety: " + reason_ + "; the coils are off, find the cause and start again");
}

void SafetySupervisor::apply(const rig::CoilPulse& pulse) {
  if (latched())
    throw common::HardwareError("safety: stopped earlier (" + reason_ + "); no pulse until a restart");
  if (!std::isfinite(pulse.duration_s) || pulse.duration_s < 0.0)
    latch(line("pulse length is ", pulse.duration_s, " s, must be 0 or more"));
  rig::CoilPulse safe = pulse;
  bool limited = false;
  for (std::size_t coil = 0; coil < safe.current_A.size(); ++coil) {
    double& current_A = safe.current_A[coil];
    if (!std::isfinite(current_A))
      latch(line("current of coil ", kCoilNames[coil], " is ", current_A, " A, must be a finite number"));
    if (std::abs(current_A) > config_.max_current_A) {
      current_A = std::clamp(current_A, -config_.max_current_A, config_.max_current_A);
      limited = true;
    }
  }
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (safe.current_A[2 * axis] != 0.0 && safe.current_A[2 * axis + 1] != 0.0)
      latch(line("opposite coils ", kCoilNames[2 * axis], " and ", kCoilNames[2 * axis + 1],
                 " driven together (", safe.current_A[2 * axis], " A and ", safe.current_A[2 * axis + 1],
                 " A)"));
  if (safe.duration_s > config_.max_pulse_s) {
    safe.duration_s = config_.max_pulse_s;
    limited = true;
  }
  const rig::CoilStatus status = coils_.status();
  if (!status.faults.empty()) latch("the coils report: " + status.faults.front());
  for (std::size_t coil = 0; coil < status.temperature_C.size(); ++coil)
    // Written so that a temperature that is not a number stops the run, too.
    if (!(status.temperature_C[coil] <= config_.max_temperature_C))
      latch(line("coil ", kCoilNames[coil], " is at ", status.temperature_C[coil], " C, limit is ",
                 config_.max_temperature_C, " C"));
  limited_ += limited ? 1 : 0;
  coils_.apply(safe);
}

}  // namespace lodestone::control
