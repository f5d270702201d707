#pragma once

namespace lodestone::geometry {

/// One of the eight ways to see a plane that take a square around its origin to itself: turned back by
/// quarters, then mirrored at the x axis or not. Signs and axes change places, so nothing is rounded.
class SquareView {
 public:
  /// The plane as it is.
  SquareView() = default;
  /// The one in which this place lies in the eighth where 0 <= y <= x.
  static SquareView of(double x, double y);

  /// A vector (place, displacement, drive along x and y), `xy` [2], as it is seen, and what is seen so.
  void enter(double* xy) const;
  void leave(double* xy) const;
  /// A heading in rad likewise, in (-pi, pi].
  double entered_rad(double heading_rad) const;
  double left_rad(double heading_rad) const;
  /// Which of the eight it is, as numbers from -1 to 1: `out` [kViewNumbers], cosine and sine of the turn,
  /// and 1, or -1 where it is mirrored.
  static constexpr int kViewNumbers = 3;
  void write_view(float* out) const;
  /// Whether what lies along x is seen along y.
  bool swaps_axes() const { return quarters_ % 2 == 1; }

 private:
  SquareView(int quarters, bool mirrored) : quarters_(quarters), mirrored_(mirrored) {}

  int quarters_ = 0;
  bool mirrored_ = false;
};

}  // namespace lodestone::geometry
