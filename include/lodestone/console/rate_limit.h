#pragma once

#include <algorithm>

namespace lodestone::console {

/// How often something may happen: `per_s` on average, `burst` at once (token bucket).
class RateLimit {
 public:
  RateLimit(double per_s, double burst) : per_s_(per_s), burst_(burst), left_(burst) {}

  /// Whether it may happen once more at `now_s`, of a clock that does not go back.
  bool take(double now_s) {
    if (started_) left_ = std::min(burst_, left_ + (now_s - last_s_) * per_s_);
    started_ = true;
    last_s_ = now_s;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double per_s_;
  double burst_;
  double left_;
  double last_s_ = 0.0;
  bool started_ = false;
};

}  // namespace lodestone::console
