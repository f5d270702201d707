#include "lodestone/control/steered_reference.h"

#include <utility>

namespace lodestone::control {

void SteeredReference::steer(std::shared_ptr<Reference> next) {
  const std::lock_guard<std::mutex> lock(mutex_);
  next_ = std::move(next);
}

void SteeredReference::end() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ended_ = true;
}

void SteeredReference::take_up(double time_s) {
  std::shared_ptr<Reference> next;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    next = std::exchange(next_, nullptr);
  }
  if (!next) return;
  followed_ = std::move(next);
  followed_->reset();
  began_s_ = time_s;
}

void SteeredReference::reset() {
  take_up(0.0);
  followed_->reset();
  began_s_ = 0.0;
}

geometry::Vector2 SteeredReference::target(double time_s, const geometry::Pose2& needle) {
  take_up(time_s);
  return followed_->target(time_s - began_s_, needle);
}

bool SteeredReference::finished(double time_s) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return ended_ || (next_ == nullptr && followed_->finished(time_s - began_s_));
}

}  // namespace lodestone::control
