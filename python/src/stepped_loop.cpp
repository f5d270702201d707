#include "stepped_loop.h"

#include <exception>
#include <utility>

namespace lodestone::python {
namespace {

/// Takes the control loop out of a run that nobody goes on with.
struct EpisodeOver : std::exception {
  const char* what() const noexcept override { return "the episode is over"; }
};

/// What it is all for is not the loop's business here.
struct NoReference final : control::Reference {
  void reset() override {}
  geometry::Vector2 target(double, const geometry::Pose2&) override { return geometry::Vector2::Zero(); }
  bool finished(double) const override { return false; }
};

}  // namespace

class SteppedLoop::Handover final : public control::Controller {
 public:
  explicit Handover(SteppedLoop& steps) : steps_(steps) {}
  void reset() override {}
  geometry::Drive act(const task::Observation& observation) override {
    return steps_.hand_over(observation.pose);
  }

 private:
  SteppedLoop& steps_;
};

SteppedLoop::SteppedLoop(session::RigSession& rig, const control::ControlLoopConfig& config,
                         const task::ActionConfig& action, const physics::RigDescription& description)
    : loop_(config, action, rig.coils(), rig.sensor(), rig.clock(), &description) {
  loop_.forget_steps();
}

std::optional<geometry::Pose2> SteppedLoop::begin() {
  end();
  ending_ = false;
  running_ = true;
  thread_ = std::thread([this] {
    Handover handover(*this);
    NoReference nowhere;
    control::LoopOutcome outcome = loop_.run(handover, nowhere);
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_reason_ = std::move(outcome.stop_reason);
    running_ = false;
    changed_.notify_all();
  });
  return wait_for_pose();
}

std::optional<geometry::Pose2> SteppedLoop::step(const geometry::Drive& action) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    action_ = action;
    changed_.notify_all();
  }
  return wait_for_pose();
}

void SteppedLoop::end() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
  pose_.reset();
  action_.reset();
}

std::optional<geometry::Pose2> SteppedLoop::wait_for_pose() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return pose_.has_value() || !running_; });
  return std::exchange(pose_, std::nullopt);
}

geometry::Drive SteppedLoop::hand_over(const geometry::Pose2& pose) {
  std::unique_lock<std::mutex> lock(mutex_);
  pose_ = pose;
  changed_.notify_all();
  changed_.wait(lock, [this] { return action_.has_value() || ending_; });
  if (ending_) throw EpisodeOver();
  return *std::exchange(action_, std::nullopt);
}

}  // namespace lodestone::python
