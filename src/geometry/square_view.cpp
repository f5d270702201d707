#include "lodestone/geometry/square_view.h"

#include <utility>

#include "lodestone/geometry/angle.h"

namespace lodestone::geometry {
namespace {

void turn(int quarters, double* xy) {
  for (int k = 0; k < quarters; ++k) xy[0] = -std::exchange(xy[1], xy[0]);
}

}  // namespace

SquareView SquareView::of(double x, double y) {
  const int quarters = x >= 0.0 && y <= x && y >= -x  ? 0
                       : y > 0.0 && y >= x && y >= -x ? 1
                       : x < 0.0 && y <= -x && y >= x ? 2
                                                      : 3;
  SquareView view(quarters, false);
  double place[2] = {x, y};
  view.enter(place);
  view.mirrored_ = place[1] < 0.0;
  return view;
}

void SquareView::enter(double* xy) const {
  turn((4 - quarters_) % 4, xy);
  if (mirrored_) xy[1] = -xy[1];
}

void SquareView::leave(double* xy) const {
  if (mirrored_) xy[1] = -xy[1];
  turn(quarters_, xy);
}

void SquareView::write_view(float* out) const {
  constexpr float kCosine[4] = {1.0F, 0.0F, -1.0F, 0.0F};
  out[0] = kCosine[quarters_];
  out[1] = kCosine[(quarters_ + 3) % 4];
  out[2] = mirrored_ ? -1.0F : 1.0F;
}

double SquareView::entered_rad(double heading_rad) const {
  const double turned_rad = heading_rad - 0.5 * kPi * quarters_;
  return wrap_angle(mirrored_ ? -turned_rad : turned_rad);
}

double SquareView::left_rad(double heading_rad) const {
  return wrap_angle((mirrored_ ? -heading_rad : heading_rad) + 0.5 * kPi * quarters_);
}

}  // namespace lodestone::geometry
