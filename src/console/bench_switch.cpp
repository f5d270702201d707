#include "bench_core.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/realtime.h"
#include "lodestone/common/thread_name.h"

namespace lodestone::console {

namespace {
constexpr double kWatch_s = 0.01;     // of the dead man's switch
constexpr double kOffWithin_s = 1.0;  // and that is waited for
}  // namespace

void Bench::State::stop(const std::string& reason) {
  bool told = true;
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    ++stops;
    told = session != nullptr || stopped_before;
    if (!session && !stopped_before) stopped_before = reason;  // it is stopped when it is back
  }
  if (!told) tell(Level::kStop, "stop: " + reason);
  const std::lock_guard<common::PriorityMutex> lock(mutex);
  if (shown.mode == Mode::kStopped || !session) return;
  shown.mode = Mode::kStopped;
  shown.reason = reason;
  shown.why_not = "looking";
  shown.clears = false;
  forget_goal();
  unattended_next = false;
  ending = Ending::kStopped;
  asked_s = -1e9;
  stop_wanted = reason;
  changed.notify_all();
}

void Bench::State::watch() {
  const common::RealtimeThread realtime;
  common::name_thread("dead-man");
  for (;;) {
    std::optional<std::string> stopped, ended;
    std::shared_ptr<session::RigSession> of;
    std::shared_ptr<control::ControlLoop> running;
    std::shared_ptr<PulseLog> through;  // what the loop stops through
    {
      std::unique_lock<common::PriorityMutex> lock(mutex);
      changed.wait_for(lock, seconds(kWatch_s), [this] { return over || stop_wanted || end_wanted; });
      if (over && !stop_wanted) return;
      const std::optional<std::string> lapse = loop ? attendance.lapse(wall.now_s()) : std::nullopt;
      if (lapse && attendance.driving() == Driving::kByHand && !end_wanted) end_wanted = lapse;
      if (lapse && attendance.driving() != Driving::kByHand && shown.mode == Mode::kRunning) {
        lock.unlock();
        stop(*lapse);
        lock.lock();
      }
      stopped = std::exchange(stop_wanted, std::nullopt);
      ended = std::exchange(end_wanted, std::nullopt);
      if (ended && loop && ending == Ending::kNone) ending = Ending::kByOperator;
      of = session;
      running = loop;
      through = pulses;
    }
    if (stopped && of)
      switch_off(*stopped, *of, running.get());
    else if (ended && running)
      running->interrupt(*ended);
  }
}

bool Bench::State::wanted_elsewhere() const {
  const std::lock_guard<common::PriorityMutex> lock(mutex);
  return over || stop_wanted || end_wanted || shown.mode != Mode::kStopped;
}

void Bench::State::switch_off(const std::string& reason, session::RigSession& of,
                              control::ControlLoop* running) {
  const double asked_at_s = of.clock().now_s();
  of.coils().request_stop(reason);  // before anything that may wait
  if (running != nullptr) running->interrupt(reason);
  parts.tell({Level::kStop, asked_at_s, "stop: " + reason});
  const double until_s = wall.now_s() + kOffWithin_s;
  try {
    for (;;) {
      const rig::CoilStatus status = of.coils().status();
      const bool off = std::all_of(status.current_A.begin(), status.current_A.end(),
                                   [](double current_A) { return std::abs(current_A) < kOff_A; });
      if (off) return tell(Level::kInfo, "coils off, as measured");
      if (wall.now_s() > until_s) break;
      if (wanted_elsewhere()) return;
      std::this_thread::sleep_for(seconds(0.002));
    }
    tell(Level::kWarning, "the coils still measure a current: use the emergency stop");
  } catch (const common::Error& error) {
    tell(Level::kWarning, std::string("nothing is known of the current in the coils: ") + error.what());
  }
}

}  // namespace lodestone::console
