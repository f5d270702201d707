#include "lodestone/console/bench.h"
#include "lodestone/common/thread_name.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/priority_mutex.h"
#include "lodestone/common/random.h"
#include "lodestone/common/realtime.h"
#include "lodestone/console/attendance.h"
#include "lodestone/console/pulse_log.h"
#include "lodestone/control/held_drive.h"
#include "lodestone/control/steered_reference.h"

namespace lodestone::console {
namespace {

using Level = BenchEvent::Level;

constexpr const char* kHand = "hand";
constexpr double kLook_s = 0.3;          // between two looks where nothing is driven
constexpr double kAskTheCoils_s = 1.0;   // between two questions to the coils then
constexpr double kWatched_s = 1.0;       // somebody looks on who has said so within this
constexpr double kConnectAgain_s = 2.0;  // after a rig that is not there
constexpr double kWatch_s = 0.01;        // of the dead man's switch
constexpr double kBlind_s = 5.0;         // a camera that gives nothing for so long is opened anew
constexpr double kOff_A = 0.1;           // less than this counts as off
constexpr double kOffWithin_s = 1.0;     // and that is waited for
constexpr double kKeep_s = 600.0;        // of samples
constexpr std::size_t kTrail = 200;      // poses
constexpr double kForGood_s = 1e9;       // a target is held until somebody ends the run

std::chrono::duration<double> seconds(double time_s) { return std::chrono::duration<double>(time_s); }

}  // namespace

struct Bench::State {
  /// How a run came to its end, where its task did not.
  enum class Ending { kNone, kByOperator, kStopped };

  explicit State(Parts given) : parts(std::move(given)) {
    shown.controller = parts.sources.front().name;
    shown.reason = "connecting";
    bench = std::thread([this] { drive_bench(); });
    switch_thread = std::thread([this] { watch(); });
  }

  Parts parts;
  common::SteadyClock wall;
  mutable common::PriorityMutex mutex;  // of what follows; never held while the rig is asked
  std::condition_variable_any changed;
  BenchState shown;
  std::deque<BenchSample> samples;
  std::deque<std::function<void()>> orders;
  std::optional<Goal> goal;  // of a run that is to begin
  std::shared_ptr<session::RigSession> session;
  std::shared_ptr<control::ControlLoop> loop;
  std::shared_ptr<control::SteeredReference> reference;
  std::shared_ptr<PulseLog> pulses;
  Attendance attendance;
  std::optional<std::string> stop_wanted, end_wanted;
  Ending ending = Ending::kNone;
  std::optional<std::string> stopped_before;  // the rig was gone
  bool unattended_next = false;
  bool cancelled = true;   // no goal has been taken whose run is about to begin
  std::int64_t stops = 0;  // how often somebody said stop
  bool released = false;
  bool over = false;
  double watched_s = -1e9;  // on the wall clock

  control::HeldDrive hand;
  common::Interruption wake;  // the thread of the bench, while it rests
  std::map<std::string, std::shared_ptr<control::RigIdentifier>> identifiers;  // by controller
  double looked_s = -1e9, seen_s = 0.0;                                        // on the wall clock
  std::atomic<double> asked_s{-1e9};  // likewise; stop() asks for another question
  std::uint64_t runs = 0;
  std::thread bench, switch_thread;

  void tell(Level level, const std::string& text) {
    double now_s = 0.0;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      now_s = now();
    }
    parts.tell({level, now_s, text});
  }
  /// On the rig's clock. Under the mutex.
  double now() const { return session ? session->clock().now_s() : wall.now_s(); }

  // ---- The thread of the bench ----

  void drive_bench() {
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
      if (order)
        order();
      else if (run)
        follow(*run);
      else if (connected)
        idle();
      else
        connect();
    }
  }

  void connect() {
    bool may = false;
    {
      std::unique_lock<common::PriorityMutex> lock(mutex);
      may = !released;
      if (released) changed.wait_for(lock, seconds(kLook_s), [this] { return over || !orders.empty(); });
    }
    if (!may) return;
    try {
      std::shared_ptr<session::RigSession> made = parts.connect();
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      session = std::move(made);
      pulses = std::make_shared<PulseLog>(session->coils(), session->clock(), parts.config.loop.period_s());
      shown.mode = stopped_before ? Mode::kStopped : Mode::kDisarmed;
      shown.reason = stopped_before.value_or("");
      shown.clears = false;
      samples.clear();
      seen_s = wall.now_s();
      note_camera();
    } catch (const common::Error& error) {
      std::unique_lock<common::PriorityMutex> lock(mutex);
      const bool known = shown.reason == error.what();
      shown.reason = error.what();
      lock.unlock();
      if (!known) tell(Level::kWarning, error.what());
      lock.lock();
      changed.wait_for(lock, seconds(kConnectAgain_s), [this] { return over || !orders.empty(); });
      return;
    }
    tell(Level::kInfo, "the rig is connected");
  }

  /// Under the mutex, in the bench's thread.
  void note_camera() {
    if (shown.camera || session->camera() == nullptr || !session->camera()->calibration()) return;
    shown.camera = session->camera()->calibration()->camera;
  }

  /// Under the mutex: what was asked for before is not done later.
  void forget_goal() {
    goal.reset();
    cancelled = true;
    hand.hold(geometry::Vector2::Zero());
  }

  void disconnect(const std::string& reason) {
    std::shared_ptr<session::RigSession> gone;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      if (shown.mode == Mode::kStopped) stopped_before = shown.reason;
      shown.mode = Mode::kDisconnected;
      shown.reason = reason;
      shown.pose.reset();
      shown.camera.reset();
      forget_goal();
      unattended_next = false;
      pulses.reset();
      gone = std::exchange(session, nullptr);
    }
    identifiers.clear();
    tell(Level::kWarning, "the rig is disconnected: " + reason);
    gone.reset();  // here, in no lock: this may take a while
  }

  void idle() {
    const double now_s = wall.now_s();
    bool look = false;
    bool stopped = false;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      look = now_s - looked_s >= kLook_s && (now_s - watched_s < kWatched_s || shown.mode == Mode::kArmed);
      stopped = shown.mode == Mode::kStopped;
    }
    if (look && !this->look()) return;
    if (now_s - asked_s >= kAskTheCoils_s && !ask_the_coils(stopped)) return;
    session->clock().wait_until(session->clock().now_s() + 0.02, &wake);
  }

  /// Whether the rig is still there.
  bool look() {
    looked_s = wall.now_s();
    control::PoseEstimate estimate;
    try {
      estimate = session->sensor().observe();
    } catch (const common::Error& error) {
      estimate.fault = true;
      estimate.reason = error.what();
    }
    if (!estimate.fault) seen_s = wall.now_s();
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      note_camera();
      shown.pose = estimate;
      if (estimate.valid) remember(estimate.pose.position_m());
      add_sample(estimate, std::nullopt);
    }
    if (wall.now_s() - seen_s < kBlind_s) return true;
    disconnect(estimate.reason);
    return false;
  }

  bool ask_the_coils(bool stopped) {
    asked_s = wall.now_s();
    try {
      const rig::CoilStatus status = session->coils().status();
      std::string why_not;
      if (stopped) why_not = cause();
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      shown.clears = stopped && !status.faults.empty();
      shown.why_not = shown.clears ? "" : why_not;
      reported = status;
    } catch (const common::Error& error) {
      disconnect(error.what());
      return false;
    }
    return true;
  }
  std::optional<rig::CoilStatus> reported;

  /// What still says stop; empty: nothing.
  std::string cause() {
    try {
      session->coils().check_cause_is_gone();
    } catch (const common::HardwareError& error) {
      return error.what();
    }
    for (std::size_t coil = 0; coil < rig::kCoilCount; ++coil)
      if (std::abs(session->coils().reported()->current_A[coil]) >= kOff_A)
        return std::string("coil ") + rig::kCoilNames[coil] + " still measures a current";
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    if (!shown.pose) return "";
    if (shown.pose->fault) return shown.pose->reason;
    const double fence_m = parts.config.safety.geofence * parts.config.rig.dish.radius_m;
    return shown.pose->valid && shown.pose->pose.position_m().norm() > fence_m
               ? "the needle lies outside the fence"
               : "";
  }

  /// Under the mutex.
  void remember(const geometry::Vector2& position_m) {
    if (!shown.trail_m.empty() && (shown.trail_m.back() - position_m).norm() < 1e-4) return;
    shown.trail_m.push_back(position_m);
    if (shown.trail_m.size() > kTrail) shown.trail_m.erase(shown.trail_m.begin());
  }
  void add_sample(const control::PoseEstimate& estimate, const std::optional<geometry::Vector2>& target_m) {
    BenchSample sample;
    sample.time_s = now();
    if (estimate.valid) {
      sample.pose = estimate.pose;
      sample.pose_age_ms = std::max(0.0, 1e3 * (sample.time_s - estimate.stamp_s));
      if (target_m) sample.error_mm = geometry::kMmPerM * (*target_m - estimate.pose.position_m()).norm();
    }
    sample.target_m = target_m;
    sample.current_A = last_A;
    sample.duty = pulses->duty(sample.time_s);
    if (const auto jitter_s = pulses->jitter_s()) sample.jitter_ms = 1e3 * *jitter_s;
    if (reported) {
      sample.temperature_C = reported->temperature_C;
      sample.supply_V = reported->supply_V;
    }
    shown.sample = sample;
    ++shown.samples;
    samples.push_back(sample);
    while (samples.front().time_s < sample.time_s - kKeep_s) samples.pop_front();
  }
  std::array<double, rig::kCoilCount> last_A{};

  std::shared_ptr<control::Reference> reference_of(const Goal& to, bool unattended) const {
    if (to.path) return std::make_shared<control::PathReference>(*to.path, parts.config.reference);
    return std::make_shared<control::PointReference>(
        to.target_m, unattended ? parts.config.trials.point_seconds : kForGood_s, to.heading_rad);
  }

  const experiments::ControllerSource& source(const std::string& name) const {
    const auto found = std::find_if(parts.sources.begin(), parts.sources.end(),
                                    [&](const auto& source) { return source.name == name; });
    return found == parts.sources.end() ? parts.sources.front() : *found;
  }

  void follow(const Goal& to) {
    const bool by_hand = to.task == kHand;
    std::string name;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      name = shown.controller;
    }
    const experiments::ControllerSource& driver = source(name);
    std::shared_ptr<control::RigIdentifier>& identifier = identifiers[driver.name];
    if (!identifier && driver.identify)
      identifier = driver.identify();  // what it finds out, the next run knows
    task::ActionConfig by_hand_action;
    by_hand_action.scale = parts.config.rig.coils.max_current_A;
    const std::unique_ptr<control::Controller> made =
        by_hand ? nullptr
                : driver.make(common::derive_seed(static_cast<std::uint64_t>(parts.config.seed),
                                                  "console run", ++runs));
    control::Controller& controller = by_hand ? static_cast<control::Controller&>(hand) : *made;
    // By hand, nothing moves the needle but the hand: no probes.
    const auto running = std::make_shared<control::ControlLoop>(
        parts.config.loop, by_hand ? by_hand_action : driver.action, *pulses, session->sensor(),
        session->clock(), by_hand ? nullptr : &parts.config.rig, by_hand ? nullptr : identifier.get());
    running->forget_steps();
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      if (std::exchange(cancelled, true) || over || shown.mode != Mode::kArmed) return;
      shown.unattended = !by_hand && std::exchange(unattended_next, false);
      const auto driving = by_hand            ? Driving::kByHand
                           : shown.unattended ? Driving::kUnattended
                                              : Driving::kAttended;
      attendance.begin(driving);
      shown.attended = !shown.unattended;
      shown.mode = Mode::kRunning;
      shown.run = BenchRun{to.task};
      aim(to);
      ending = Ending::kNone;
      end_wanted.reset();
      loop = running;
      reference = std::make_shared<control::SteeredReference>(reference_of(to, shown.unattended));
      pulses->begin_run();
    }
    tell(Level::kInfo, "run begins: " + to.task + ", " + name);
    const control::LoopOutcome outcome =
        running->run(controller, *reference, [this](const control::StepRecord& step) { note(step); });
    finish(outcome);
  }

  /// Under the mutex.
  void aim(const Goal& to) {
    const bool point = !to.path && to.task != kHand;
    shown.run->task = to.task;
    shown.run->aimed_s = shown.run->time_s;
    shown.target_heading_rad = point ? to.heading_rad : std::nullopt;
    shown.plan_m = to.path ? to.path->points_m() : std::vector<geometry::Vector2>{};
    shown.target_m = point ? std::optional(to.target_m) : std::nullopt;
  }

  void note(const control::StepRecord& step) {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    note_camera();
    shown.pose = step.estimate;
    if (step.estimate.valid) remember(step.estimate.pose.position_m());
    if (attendance.driving() != Driving::kByHand) shown.target_m = step.target_m;
    shown.run->time_s = step.time_s;
    ++shown.run->steps;
    last_A = step.current_A;
    reported = session->coils().reported();
    add_sample(step.estimate, shown.target_m);
  }

  void finish(const control::LoopOutcome& outcome) {
    std::string reason = outcome.stop_reason;
    Ending how = Ending::kNone;
    {
      const std::lock_guard<common::PriorityMutex> lock(mutex);
      how = ending;
      attendance.end();
      loop.reset();
      reference.reset();
      shown.run.reset();
      shown.unattended = shown.attended = false;
      shown.target_m.reset();
      last_A = {};
      if (shown.mode == Mode::kRunning && (outcome.completed || how == Ending::kByOperator))
        shown.mode = Mode::kArmed;
    }
    if (outcome.completed) return tell(Level::kInfo, "run ended: done");
    if (how != Ending::kStopped && session->coils().latched()) return stop(session->coils().reason());
    if (how == Ending::kByOperator) return tell(Level::kInfo, "run ended: " + reason);
    if (how == Ending::kStopped) return;  // who stopped it has told
    stop(reason);
  }

  void stop(const std::string& reason) {
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

  // ---- The thread of the dead man's switch ----

  void watch() {
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

  /// Whether the switch has to look at something else than at coils that go off.
  bool wanted_elsewhere() const {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    return over || stop_wanted || end_wanted || shown.mode != Mode::kStopped;
  }

  void switch_off(const std::string& reason, session::RigSession& of, control::ControlLoop* running) {
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

  /// Something that only the bench's thread may do; `done` is told what it throws.
  void order(Done done, std::function<void()> action) {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    orders.push_back([done = std::move(done), action = std::move(action)] {
      std::string why_not;
      try {
        action();
      } catch (const common::Error& error) {
        why_not = error.what();
      }
      if (done) done(why_not);
    });
    wake.raise();
    changed.notify_all();
  }

  void need(Mode mode, const char* otherwise) const {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    if (shown.mode != mode) throw common::HardwareError(otherwise);
  }
  /// From a mode that is still the one it was, unless somebody has said stop since there were so many.
  void enter(Mode from, Mode mode, std::int64_t stops_before) {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    if (shown.mode != from || stops != stops_before) throw common::HardwareError("it was stopped meanwhile");
    shown.mode = mode;
    forget_goal();
    if (mode != Mode::kArmed) return;
    shown.reason.clear();
    stopped_before.reset();
  }
  std::int64_t stops_so_far() const {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    return stops;
  }
};

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
    state_->tell(Level::kInfo, "armed");
  });
}

void Bench::disarm(Done done) {
  state_->order(std::move(done), [this, stops = state_->stops_so_far()] {
    state_->need(Mode::kArmed, "only a bench that is armed can be disarmed");
    state_->session->coils().stop();
    state_->enter(Mode::kArmed, Mode::kDisarmed, stops);
    state_->tell(Level::kInfo, "disarmed");
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
    state.tell(Level::kInfo, "re-armed after: " + reason);
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

void Bench::show_plan(const std::vector<geometry::Vector2>& points_m) {
  const std::lock_guard<common::PriorityMutex> lock(state_->mutex);
  if (state_->shown.mode != Mode::kRunning) state_->shown.plan_m = points_m;
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
    state.goal = Goal{kHand, {}, std::nullopt, std::nullopt};
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
