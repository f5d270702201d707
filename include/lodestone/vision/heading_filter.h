#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lodestone/physics/pulse_outcome.h"

namespace lodestone::vision {

/// Where the needle's head is, when an image shows the needle's axis better than its tape. A magnet turns
/// towards the field that it is given, the shorter way, and stops anywhere on that way (what friction leaves
/// of it): from where the head was and the field since, one end of the axis is far likelier than the other,
/// however far the needle has turned. A histogram over all headings, so that no assumption is made about how
/// many are possible.
class HeadingFilter {
 public:
  HeadingFilter() { reset(); }

  /// Any heading is possible.
  void reset();
  /// The coils made a field of this direction where the needle lies; with the probability `sticks` it did not
  /// stir.
  void pulse(double field_rad, double sticks = 0.4);
  /// The same where a learned simulator says where the head may be now; `known` is the probability that it
  /// was where that took it to be.
  void pulse(const std::vector<physics::PulseOutcome>& outcomes, double known);

  /// The axis as an image shows it, `angle_rad` towards the end that the tape speaks for with `tape_log_odds`
  /// >= 0 (0: no tape was seen). Returns the probability that the head is there. Images between two pulses
  /// show the same thing with the same errors: the one with the clearest tape counts, not their number; but
  /// the tape of one image alone is never quite believed. An
  /// axis where the needle cannot have come, and three clear tapes in a row that contradict what is believed,
  /// say that something else has moved it: then the tape alone counts.
  double see(double angle_rad, double sigma_rad, double tape_log_odds);

 private:
  static constexpr int kBins = 360;
  using Histogram = std::array<double, kBins>;
  static int bin_of(double angle_rad);
  static void add_peak(Histogram& to, double angle_rad, double sigma_rad, double mass);
  void expect(const Histogram& after);
  void start_over();
  void remember_tape(double angle_rad, double log_odds);
  static double mass_near(const Histogram& of, double angle_rad, double sigma_rad);

  Histogram before_{};              // since the last pulse, before any image
  Histogram now_{};                 // with the images since
  double tape_log_odds_ = 0.0;      // of the clearest tape since the last pulse,
  double tape_at_rad_ = 0.0;        // which speaks for this end,
  int tapes_ = 0;                   // as so many images in a row do
  std::optional<double> axis_rad_;  // in the last image since the last pulse
  int contradictions_ = 0;
};

}  // namespace lodestone::vision
