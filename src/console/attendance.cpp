#include "lodestone/console/attendance.h"

namespace lodestone::console {

void Attendance::beat(double now_s, bool visible, bool focused) {
  beat_s_ = now_s;
  visible_ = visible;
  focused_ = focused;
}

void Attendance::handed_over(double now_s) { beat(now_s, true, true); }

std::optional<std::string> Attendance::lapse(double now_s) const {
  if (driving_ == Driving::kNobody || driving_ == Driving::kUnattended) return std::nullopt;
  if (now_s - beat_s_ > kSilence_s) return "the operator's page is silent";
  if (!visible_) return "the operator's page is hidden";
  if (driving_ == Driving::kAttended) return std::nullopt;
  if (!focused_) return "the operator's page has lost the focus";
  if (now_s - held_s_ > kSilence_s) return "nothing has been heard of the hand that drives";
  return std::nullopt;
}

}  // namespace lodestone::console
