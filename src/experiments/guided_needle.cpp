#include "lodestone/experiments/guided_needle.h"

#include "lodestone/common/error.h"
#include "lodestone/control/reference.h"

namespace lodestone::experiments {
namespace {

constexpr int kLooksUntilLost = 10;
constexpr double kLongestWay_s = 15.0;

/// Pulls until the needle is near the target.
class Bringing final : public control::Controller {
 public:
  Bringing(control::Controller& inner, const geometry::Vector2& target_m, double within_m)
      : inner_(inner), target_m_(target_m), within_m_(within_m) {}
  void reset() override {
    inner_.reset();
    there_ = false;
  }
  geometry::Drive act(const task::Observation& observation) override {
    there_ = (observation.pose.position_m() - target_m_).norm() <= within_m_;
    return there_ ? observation.rest() : inner_.act(observation);
  }
  bool there() const { return there_; }

 private:
  control::Controller& inner_;
  geometry::Vector2 target_m_;
  double within_m_;
  bool there_ = false;
};

/// Its target, until it is there.
class UntilBrought final : public control::Reference {
 public:
  UntilBrought(const geometry::Vector2& target_m, const Bringing& bringing)
      : target_m_(target_m), bringing_(bringing) {}
  void reset() override {}
  geometry::Vector2 target(double, const geometry::Pose2&) override { return target_m_; }
  bool finished(double time_s) const override { return bringing_.there() || time_s >= kLongestWay_s; }

 private:
  geometry::Vector2 target_m_;
  const Bringing& bringing_;
};

}  // namespace

GuidedNeedle::GuidedNeedle(const GuidedNeedleConfig& config, const rig::RigConfig& rig,
                           session::RigSession& session)
    : config_(config),
      rig_(rig),
      session_(session),
      drive_(rig),
      controller_(control::decorate(std::make_unique<control::DipolePullController>(rig, config.baseline),
                                    config.decorators, drive_)),
      refusals_(rig.dish.radius_m),
      looked_s_(session.clock().now_s()),
      pulse_ends_s_(looked_s_) {}

void GuidedNeedle::begin() {
  session_.sensor().forget();
  here_.reset();
  looked_s_ = pulse_ends_s_ = session_.clock().now_s();
  session_.sensor().acquire();
}

control::PoseEstimate GuidedNeedle::observed() {
  common::Clock& clock = session_.clock();
  clock.sleep_until(looked_s_ + config_.look_s);
  looked_s_ = clock.now_s();
  session_.coils().begin_step(looked_s_);  // asks whether somebody wants to stop
  control::PoseEstimate estimate = session_.sensor().observe();
  session_.coils().observe(estimate);
  if (estimate.valid) here_ = estimate.pose;
  return estimate;
}

control::PoseEstimate GuidedNeedle::look() {
  control::PoseEstimate estimate = observed();
  refusals_.add(estimate);
  return estimate;
}

control::PoseEstimate GuidedNeedle::look_during(const rig::CoilPulse& pulse) {
  session_.sensor().pulsed(pulse.current_A, {});
  control::PoseEstimate estimate = look();
  here_.reset();  // it may still be on its way
  return estimate;
}

control::PoseEstimate GuidedNeedle::fresh_look() {
  session_.sensor().expect_nothing();
  const control::PoseEstimate seen = observed();
  return seen.valid ? seen : observed();  // of a needle that nobody expects, one image is not believed
}

std::optional<geometry::Pose2> GuidedNeedle::here() {
  for (int i = 0; i < kLooksUntilLost && !here_; ++i) look();
  return here_;
}

void GuidedNeedle::pulse(const rig::CoilPulse& pulse) {
  LODESTONE_CHECK(here_.has_value(), "a needle that has been seen since the last pulse");
  here_.reset();
  session_.coils().apply(pulse);
  session_.sensor().pulsed(pulse.current_A, {});
  pulse_ends_s_ = session_.clock().now_s() + pulse.duration_s;
}

void GuidedNeedle::rest() { session_.clock().sleep_until(pulse_ends_s_ + config_.loop.rest_s); }

std::optional<PulseMotion> GuidedNeedle::push_along(const geometry::Vector2& direction_A) {
  const std::optional<geometry::Pose2> at = here();
  if (!at) return std::nullopt;
  return push(drive_.along(direction_A, at->position_m()));
}

std::optional<PulseMotion> GuidedNeedle::push(const geometry::Drive& drive_A) {
  const std::optional<geometry::Pose2> before = here();
  if (!before) return std::nullopt;
  pulse({drive_.current_A(drive_A, before->position_m()), config_.loop.pulse_s});
  rest();
  const std::optional<geometry::Pose2> after = here();
  if (!after) return std::nullopt;
  return PulseMotion{*before, *after};
}

bool GuidedNeedle::bring_to(const geometry::Vector2& target_m, double within_m) {
  here_.reset();
  Bringing bringing(*controller_, target_m, within_m);
  UntilBrought reference(target_m, bringing);
  task::ActionConfig action;
  action.scale = rig_.coils.max_current_A;
  action.size = rig_.drive_size();
  control::ControlLoop loop(config_.loop, action, session_.coils(), session_.sensor(), session_.clock(),
                            &rig_);
  const control::LoopOutcome outcome = loop.run(
      bringing, reference, [this](const control::StepRecord& step) { refusals_.add(step.estimate); });
  if (!outcome.completed) throw common::HardwareError(outcome.stop_reason);
  if (!outcome.steps.empty() && outcome.steps.back().estimate.valid)
    here_ = outcome.steps.back().estimate.pose;
  looked_s_ = session_.clock().now_s();
  return bringing.there();
}

rig::CoilPulse GuidedNeedle::pulse_along(const geometry::Vector2& direction_A,
                                         const geometry::Vector2& position_m) const {
  return {drive_.current_A(drive_.along(direction_A, position_m), position_m), config_.loop.pulse_s};
}

}  // namespace lodestone::experiments
