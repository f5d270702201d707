#include "lodestone/console/bench.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <utility>

#include "bench_core.h"
#include "lodestone/common/error.h"
#include "lodestone/common/thread_name.h"

namespace lodestone::console {

Bench::State::State(Parts given) : parts(std::move(given)), hand(physics::CoilDrive(parts.config.rig)) {
  shown.controller = parts.sources.front().name;
  shown.keep_out = parts.config.safety.keeps_out(parts.config.rig);
  shown.reason = "connecting";
  bench = std::thread([this] { drive_bench(); });
  switch_thread = std::thread([this] { watch(); });
}

void Bench::State::drive_bench() {
  common::name_thread("bench");
  for (;;) {
    std::function<void()> order;
    std::optional<Goal> run;
    bool connected = false;
    {
      std::unique_lock<common::PriorityMutex> lock(mutex);
      if (over) return;
      wake.clear();
      connected = session != nullptr;
      if (!orders.empty()) {
        order = std::move(orders.front());
        orders.pop_front();
      } else if (goal && shown.mode == Mode::kArmed) {
        run = std::move(goal);
        goal.reset();
        cancelled = false;
      }
    }
    try {
      if (order)
        order();
      else if (run)
        follow(*run);
      else if (connected)
        idle();
      else
        connect();
    } catch (const std::exception& error) {  // whatever it is: coils off, and the page goes on
      stop(error.what());
    }
  }
}

void Bench::State::tell(Level level, const std::string& text) {
  double now_s = 0.0;
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    now_s = now();
  }
  parts.tell({level, now_s, text});
}

void Bench::State::order(Done done, std::function<void()> action) {
  const std::lock_guard<common::PriorityMutex> lock(mutex);
  orders.push_back([done = std::move(done), action = std::move(action)] {
    std::string why_not;
    try {
      action();
    } catch (const std::exception& error) {
      why_not = error.what();
    }
    if (done) done(why_not);
  });
  wake.raise();
  changed.notify_all();
}

void Bench::State::need(Mode mode, const char* otherwise) const {
  const std::lock_guard<common::PriorityMutex> lock(mutex);
  if (shown.mode != mode) throw common::HardwareError(otherwise);
}

void Bench::State::enter(Mode from, Mode mode, std::int64_t stops_before) {
  const std::lock_guard<common::PriorityMutex> lock(mutex);
  if (shown.mode != from || stops != stops_before) throw common::HardwareError("it was stopped meanwhile");
  shown.mode = mode;
  forget_goal();
  if (mode != Mode::kArmed) return;
  shown.reason.clear();
  stopped_before.reset();
}

std::int64_t Bench::State::stops_so_far() const {
  const std::lock_guard<common::PriorityMutex> lock(mutex);
  return stops;
}

void Bench::State::forget_goal() {
  goal.reset();
  cancelled = true;
  hand.hold(geometry::Vector2::Zero());
}

Bench::Bench(Parts parts) : state_(std::make_unique<State>(std::move(parts))) {}

Bench::~Bench() { end(); }

void Bench::end() {
  State& state = *state_;
  if (!state.bench.joinable()) return;
  const Mode mode = this->state().mode;
  if (mode == Mode::kRunning || mode == Mode::kArmed) stop("the console ends");
  {
    const std::lock_guard<common::PriorityMutex> lock(state.mutex);
    state.over = true;
    state.wake.raise();
    state.changed.notify_all();
  }
  state.switch_thread.join();
  state.bench.join();
}

void Bench::arm(Done done) {
  state_->order(std::move(done), [this, stops = state_->stops_so_far()] {
    state_->need(Mode::kDisarmed, "only a bench that is disarmed can be armed");
    state_->session->coils().check_cause_is_gone();
    state_->enter(Mode::kDisarmed, Mode::kArmed, stops);
    state_->tell(State::Level::kInfo, "armed");
  });
}

void Bench::disarm(Done done) {
  state_->order(std::move(done), [this, stops = state_->stops_so_far()] {
    state_->need(Mode::kArmed, "only a bench that is armed can be disarmed");
    state_->session->coils().stop();
    state_->enter(Mode::kArmed, Mode::kDisarmed, stops);
    state_->tell(State::Level::kInfo, "disarmed");
  });
}

void Bench::rearm(const std::string& reason, bool clears, Done done) {
  state_->order(std::move(done), [this, reason, clears, stops = state_->stops_so_far()] {
    State& state = *state_;
    state.need(Mode::kStopped, "the bench is not stopped");
    if (const std::string now = this->state().reason; now != reason)
      throw common::HardwareError("it has been stopped for another reason since: " + now);
    const std::vector<std::string> faults = state.session->coils().status().faults;
    if (!faults.empty() && !clears)
      throw common::HardwareError("the coil controller has latched a fault since: " + faults.front());
    if (!faults.empty()) state.session->clear_faults();
    if (const std::string why_not = state.cause(); !why_not.empty()) throw common::HardwareError(why_not);
    state.session->coils().rearm();
    try {
      state.enter(Mode::kStopped, Mode::kArmed, stops);
    } catch (const common::HardwareError& error) {
      state.session->coils().request_stop(error.what());
      throw;
    }
    state.tell(State::Level::kInfo, "re-armed after: " + reason);
  });
}

void Bench::place(Done done) {
  state_->order(std::move(done), [this] {
    State& state = *state_;
    if (!state.session) throw common::HardwareError("the rig is not connected");
    state.session->place({});
    state.identifiers.clear();
    const std::lock_guard<common::PriorityMutex> lock(state.mutex);
    state.shown.trail_m.clear();
    state.shown.pose.reset();
  });
}

void Bench::let_go(const std::string& reason, Done done) {
  state_->order(std::move(done), [this, reason] {
    {
      const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
      if (state_->shown.mode == Mode::kStopped)
        throw common::HardwareError("the bench is stopped: re-arm it first");
      state_->released = true;
    }
    if (state_->session) state_->disconnect(reason);
  });
}

void Bench::take_up() {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  state_->released = false;
  state_->changed.notify_all();
}

std::string Bench::choose(const std::string& controller) {
  State& state = *state_;
  const std::lock_guard<common::PriorityMutex> lock(state.mutex);
  if (state.shown.mode == Mode::kRunning || state.goal) return "a run is under way: end it first";
  if (controller != kHand && state.source(controller).name != controller)
    return "there is no controller " + controller;
  state.shown.controller = controller;
  return "";
}

std::string Bench::set_unattended(bool on) {
  State& state = *state_;
  const std::lock_guard<common::PriorityMutex> lock(state.mutex);
  if (state.shown.mode == Mode::kRunning) return "a run is under way: it stays as it was begun";
  state.unattended_next = on;
  return "";
}

namespace {
/// Why a run cannot begin; empty: it can.
std::string why_not_in(Mode mode) {
  switch (mode) {
    case Mode::kArmed:
    case Mode::kRunning:
      return "";
    case Mode::kDisarmed:
      return "the bench is disarmed: arm it first";
    case Mode::kStopped:
      return "the bench is stopped: re-arm it first";
    case Mode::kDisconnected:
      break;
  }
  return "the rig is not connected";
}
}  // namespace

std::string Bench::drive(const Goal& goal) {
  State& state = *state_;
  const std::lock_guard<common::PriorityMutex> lock(state.mutex);
  if (const std::string why_not = why_not_in(state.shown.mode); !why_not.empty()) return why_not;
  if (state.shown.controller == kHand) return "the needle is driven by hand: choose a controller";
  if (state.shown.mode == Mode::kArmed) {
    state.goal = goal;
    state.wake.raise();
    return "";
  }
  if (!state.reference || state.ending != State::Ending::kNone) return "the run is ending: try again";
  state.reference->steer(state.reference_of(goal, state.shown.unattended));
  state.aim(goal);
  return "";
}

void Bench::show_plan(const std::optional<geometry::Path>& path) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  if (state_->shown.mode != Mode::kRunning) state_->show(path);
}

std::string Bench::hold(const geometry::Vector2& drive) {
  State& state = *state_;
  const std::lock_guard<common::PriorityMutex> lock(state.mutex);
  state.hand.hold(drive);
  if (drive.isZero()) {
    state.goal.reset();
    state.cancelled = true;
    if (state.loop && state.attendance.driving() == Driving::kByHand) {
      state.end_wanted = "let go";
      state.changed.notify_all();
    }
    return "";
  }
  if (state.shown.controller != kHand) return "choose `hand` to drive by hand";
  if (const std::string why_not = why_not_in(state.shown.mode); !why_not.empty()) return why_not;
  state.attendance.held(state.wall.now_s());
  if (state.shown.mode == Mode::kArmed && !state.goal) {
    state.goal = Goal{kHand, {}, std::nullopt, std::nullopt, {}};
    state.wake.raise();
  }
  return "";
}

std::string Bench::end_run() {
  State& state = *state_;
  const std::lock_guard<common::PriorityMutex> lock(state.mutex);
  const bool begins = state.goal.has_value() || !state.cancelled;
  state.goal.reset();
  state.cancelled = true;
  if (!state.loop) return begins ? "" : "nothing is running";
  state.end_wanted = "the operator has ended it";
  state.changed.notify_all();
  return "";
}

void Bench::stop(const std::string& reason) { state_->stop(reason); }

void Bench::beat(bool visible, bool focused) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  state_->attendance.beat(state_->wall.now_s(), visible, focused);
}

void Bench::handed_over(bool to_somebody) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  state_->unattended_next = false;  // who wished for it is no longer in charge
  if (to_somebody) state_->attendance.handed_over(state_->wall.now_s());
}

BenchState Bench::state() const {
  const State& state = *state_;
  const std::lock_guard<common::PriorityMutex> lock(state.mutex);
  BenchState shown = state.shown;
  shown.now_s = state.now();
  if (state.pulses) shown.on_A = state.pulses->on_A(shown.now_s);
  if (shown.mode != Mode::kRunning) shown.unattended = state.unattended_next;
  if (shown.run && shown.unattended && shown.plan_m.empty())
    shown.run->left_s =
        std::max(0.0, state.parts.config.trials.point_seconds - (shown.run->time_s - shown.run->aimed_s));
  return shown;
}

std::vector<BenchSample> Bench::samples() const {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  return {state_->samples.begin(), state_->samples.end()};
}

std::shared_ptr<const imaging::Frame> Bench::image() const {
  std::shared_ptr<session::RigSession> of;
  {
    const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
    of = state_->session;
  }
  return of ? of->latest_image() : nullptr;
}

void Bench::watched() {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  state_->watched_s = state_->wall.now_s();
}

}  // namespace lodestone::console
