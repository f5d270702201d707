#pragma once

#include <cstdint>
#include <optional>

namespace lodestone::console {

using PageId = std::int64_t;

/// Who operates: one page at a time. Another one that would like to asks, and has the seat when the operator
/// yields, does not answer, or is gone.
class Seat {
 public:
  static constexpr double kAnswer_s = 15.0;  ///< so long the operator has to answer,
  static constexpr double kGone_s = 2.0;     ///< and after so long a silence is gone

  /// Whether it has the seat now; else the operator is asked, unless another page has asked already.
  bool ask(PageId page, double now_s);
  /// The operator hands over to who has asked, or gets up.
  void yield(PageId page, double now_s);
  void refuse(PageId page);
  /// A page is closed.
  void leave(PageId page, double now_s);
  /// Its heartbeat.
  void beat(PageId page, double now_s);
  /// Hands over where the operator has not answered in time, or is gone. Whether it did.
  bool settle(double now_s);

  bool operates(PageId page) const { return operator_ == page; }
  std::optional<PageId> operating() const { return operator_; }
  std::optional<PageId> asking() const { return asking_; }
  double answer_left_s(double now_s) const { return asked_s_ + kAnswer_s - now_s; }

 private:
  void hand_over(double now_s);

  std::optional<PageId> operator_;
  std::optional<PageId> asking_;
  double asked_s_ = 0.0;
  double heard_s_ = 0.0;  // the operator
};

}  // namespace lodestone::console
