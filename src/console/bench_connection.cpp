#include "bench_core.h"

#include <cmath>
#include <exception>
#include <mutex>
#include <utility>

#include "lodestone/common/error.h"

namespace lodestone::console {

namespace {
constexpr double kLook_s = 0.3;          // between two looks where nothing is driven
constexpr double kAskTheCoils_s = 1.0;   // between two questions to the coils then
constexpr double kWatched_s = 1.0;       // somebody looks on who has said so within this
constexpr double kConnectAgain_s = 2.0;  // after a rig that is not there
constexpr double kBlind_s = 5.0;         // a camera that gives nothing for so long is opened anew
}  // namespace

void Bench::State::connect() {
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
    pulses = std::make_shared<PulseLog>(session->coils(), session->clock(), parts.config.loop.period_s(),
                                        parts.config.rig.coils.count());
    shown.mode = stopped_before ? Mode::kStopped : Mode::kDisarmed;
    shown.reason = stopped_before.value_or("");
    shown.clears = false;
    samples.clear();
    note_camera();
  } catch (const std::exception& error) {
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

void Bench::State::disconnect(const std::string& reason) {
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

void Bench::State::note_camera() {
  if (shown.camera || session->camera() == nullptr || !session->camera()->calibration()) return;
  shown.camera = session->camera()->calibration()->camera;
}

void Bench::State::idle() {
  const double now_s = wall.now_s();
  bool look = false;
  bool stopped = false;
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    look = now_s - looked_s >= kLook_s && (now_s - watched_s < kWatched_s || shown.mode == Mode::kArmed);
    stopped = shown.mode == Mode::kStopped;
  }
  if (look && !parts.config.safety.keep_out_file.empty()) read_zones();
  if (look && !this->look()) return;
  if (now_s - asked_s >= kAskTheCoils_s && !ask_the_coils(stopped)) return;
  session->clock().wait_until(session->clock().now_s() + 0.02, &wake);
}

void Bench::State::read_zones() {
  try {
    geometry::KeepOut now = parts.config.safety.keeps_out(parts.config.rig);
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    note_zones(std::move(now.zones));
    zones_fault.clear();
  } catch (const common::ConfigError& error) {
    if (std::exchange(zones_fault, error.what()) != error.what())
      tell(Level::kWarning, zones_fault + "; a run will be stopped");
  }
}

bool Bench::State::look() {
  looked_s = wall.now_s();
  control::PoseEstimate estimate;
  try {
    estimate = session->sensor().observe();
  } catch (const std::exception& error) {
    estimate.fault = true;
    estimate.reason = error.what();
  }
  if (!estimate.fault) blind_since_s.reset();
  if (estimate.fault && !blind_since_s) blind_since_s = wall.now_s();
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    note_camera();
    shown.pose = estimate;
    if (estimate.valid) remember(estimate.pose.position_m());
    add_sample(estimate, std::nullopt);
  }
  if (!blind_since_s || wall.now_s() - *blind_since_s < kBlind_s) return true;
  blind_since_s.reset();
  disconnect(estimate.reason);
  return false;
}

bool Bench::State::ask_the_coils(bool stopped) {
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

std::string Bench::State::cause() {
  try {
    session->coils().check_cause_is_gone();
  } catch (const common::HardwareError& error) {
    return error.what();
  }
  for (std::size_t coil = 0; coil < session->coils().reported()->current_A.size(); ++coil)
    if (std::abs(session->coils().reported()->current_A[coil]) >= kOff_A)
      return "coil " + parts.config.rig.coils.name(coil) + " still measures a current";
  const std::lock_guard<common::PriorityMutex> lock(mutex);
  if (!shown.pose) return "";
  if (shown.pose->fault) return shown.pose->reason;
  const double fence_m = parts.config.safety.geofence * parts.config.rig.dish.radius_m;
  return shown.pose->valid && shown.pose->pose.position_m().norm() > fence_m
             ? "the needle lies outside the fence"
             : "";
}

}  // namespace lodestone::console
