#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "lodestone/control/reference.h"

namespace lodestone::control {

/// A reference that somebody else exchanges for another, or ends, while it is followed. Each is told the time
/// since it was taken up.
class SteeredReference final : public Reference {
 public:
  explicit SteeredReference(std::shared_ptr<Reference> first) : next_(std::move(first)) {}

  /// From any thread: from the next step on this one is followed.
  void steer(std::shared_ptr<Reference> next);
  /// From any thread: there is nothing left to follow.
  void end();

  void reset() override;
  geometry::Vector2 target(double time_s, const geometry::Pose2& needle) override;
  std::optional<double> target_heading_rad() const override { return followed_->target_heading_rad(); }
  std::vector<task::TargetAhead> ahead(double time_s, double step_s, int count) const override {
    return followed_->ahead(time_s - began_s_, step_s, count);
  }
  bool awaits() const override { return followed_->awaits(); }
  bool finished(double time_s) const override;

 private:
  void take_up(double time_s);

  mutable std::mutex mutex_;  // of next_ and ended_
  std::shared_ptr<Reference> next_;
  bool ended_ = false;
  std::shared_ptr<Reference> followed_;
  double began_s_ = 0.0;
};

}  // namespace lodestone::control
