#include "lodestone/console/seat.h"

#include <utility>

namespace lodestone::console {

void Seat::hand_over(double now_s) {
  operator_ = std::exchange(asking_, std::nullopt);
  heard_s_ = now_s;
}

bool Seat::ask(PageId page, double now_s) {
  if (operator_ == page) return true;
  if (!asking_) {
    asking_ = page;
    asked_s_ = now_s;
  }
  if (asking_ == page && (!operator_ || now_s - heard_s_ > kGone_s)) hand_over(now_s);
  return operator_ == page;
}

void Seat::yield(PageId page, double now_s) {
  if (operator_ == page) hand_over(now_s);
}

void Seat::refuse(PageId page) {
  if (operator_ == page) asking_.reset();
}

void Seat::leave(PageId page, double now_s) {
  if (asking_ == page) asking_.reset();
  if (operator_ == page) hand_over(now_s);
}

void Seat::beat(PageId page, double now_s) {
  if (operator_ == page) heard_s_ = now_s;
}

bool Seat::settle(double now_s) {
  if (!asking_) return false;
  const bool waits = operator_ && answer_left_s(now_s) > 0.0 && now_s - heard_s_ <= kGone_s;
  if (waits) return false;
  hand_over(now_s);
  return true;
}

}  // namespace lodestone::console
