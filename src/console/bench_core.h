#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/common/priority_mutex.h"
#include "lodestone/console/attendance.h"
#include "lodestone/console/bench.h"
#include "lodestone/console/pulse_log.h"
#include "lodestone/control/control_loop.h"
#include "lodestone/control/held_drive.h"
#include "lodestone/control/routed_reference.h"
#include "lodestone/control/steered_reference.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/rig/driver_coils.h"

namespace lodestone::console {

inline constexpr const char* kHand = "hand";  // the controller that is the operator's hand, and its task
inline constexpr double kOff_A = rig::kDriverOff_A;  // a coil that measures less than this is off

inline std::chrono::duration<double> seconds(double time_s) { return std::chrono::duration<double>(time_s); }

/// What the two threads of a bench and those who ask share.
struct Bench::State {
  using Level = BenchEvent::Level;
  /// How a run came to its end, where its task did not.
  enum class Ending { kNone, kByOperator, kStopped };

  explicit State(Parts given);

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
  std::shared_ptr<control::RoutedReference> routed;  // that it follows; null: it goes straight
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
  double looked_s = -1e9;                                                      // on the wall clock
  std::string zones_fault;                                                     // told already
  std::optional<double> blind_since_s;  // the sensor has failed since, on the wall clock
  std::atomic<double> asked_s{-1e9};    // likewise; stop() asks for another question
  std::uint64_t runs = 0;
  std::optional<rig::CoilStatus> reported;      // by the coils, last
  physics::PerCoil last_A{0.0, 0.0, 0.0, 0.0};  // as asked in the last step
  std::thread bench, switch_thread;

  // The thread of the bench, and what it is asked to do.
  void drive_bench();
  void tell(Level level, const std::string& text);
  /// Something that only the bench's thread may do; `done` is told what it throws.
  void order(Done done, std::function<void()> action);
  void need(Mode mode, const char* otherwise) const;
  /// From a mode that is still the one it was, unless somebody has said stop since there were so many.
  void enter(Mode from, Mode mode, std::int64_t stops_before);
  std::int64_t stops_so_far() const;
  /// Under the mutex: what was asked for before is not done later.
  void forget_goal();
  /// On the rig's clock. Under the mutex.
  double now() const { return session ? session->clock().now_s() : wall.now_s(); }

  // The rig between runs (bench_connection.cpp).
  void connect();
  void disconnect(const std::string& reason);
  /// Under the mutex, in the bench's thread.
  void note_camera();
  void idle();
  /// What a file tells of zones meanwhile. One that cannot be read stops the run that comes.
  void read_zones();
  /// Whether the rig is still there.
  bool look();
  bool ask_the_coils(bool stopped);
  /// What still says stop; empty: nothing.
  std::string cause();

  // A run (bench_run.cpp).
  /// Under the mutex.
  std::shared_ptr<control::Reference> reference_of(const Goal& to, bool unattended);
  const experiments::ControllerSource& source(const std::string& name) const;
  void follow(const Goal& to);
  /// Under the mutex.
  void aim(const Goal& to);
  void show(const std::optional<geometry::Path>& path);
  void note(const control::StepRecord& step);
  /// Under the mutex.
  void note_zones(std::vector<geometry::Zone> zones);
  void finish(const control::LoopOutcome& outcome);
  /// Under the mutex.
  void remember(const geometry::Vector2& position_m);
  void add_sample(const control::PoseEstimate& estimate, const std::optional<geometry::Vector2>& target_m);

  // Stops, and the thread of the dead man's switch (bench_switch.cpp).
  void stop(const std::string& reason);
  void watch();
  /// Whether the switch has to look at something else than at coils that go off.
  bool wanted_elsewhere() const;
  void switch_off(const std::string& reason, session::RigSession& of, control::ControlLoop* running);
};

}  // namespace lodestone::console
