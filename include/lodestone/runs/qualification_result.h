#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lodestone::runs {

/// A number that was measured, from how many, and its 95 % interval where they are enough for one.
struct Measured {
  double value = 0.0;
  std::int64_t n = 0;
  std::optional<std::array<double, 2>> interval = {};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("value", value);
    v.field("n", n);
    v.field("interval", interval);
  }
};

/// Looks at a needle that lies still. Spreads are standard deviations.
struct StillFigures {
  std::int64_t refused = 0;  ///< looks without a pose
  Measured x_mm, y_mm, heading_deg;
  /// RMS of position (per axis) and heading in units of the spread that the sensor reports; absent where it
  /// reports none.
  std::optional<Measured> whitened_position = {}, whitened_heading = {};
  std::optional<double> reported_mm = {}, reported_deg = {};  ///< that spread (RMS, per axis)
  Measured drift_mm_per_min;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("refused", refused);
    v.field("x_mm", x_mm);
    v.field("y_mm", y_mm);
    v.field("heading_deg", heading_deg);
    v.field("whitened_position", whitened_position);
    v.field("whitened_heading", whitened_heading);
    v.field("reported_mm", reported_mm);
    v.field("reported_deg", reported_deg);
    v.field("drift_mm_per_min", drift_mm_per_min);
  }
};

/// Looks in a square of the dish (its centre), or at headings from `heading_from_deg` on.
struct RefusalBin {
  double x_mm = 0.0, y_mm = 0.0, heading_from_deg = 0.0;
  std::int64_t looks = 0, refused = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("x_mm", x_mm);
    v.field("y_mm", y_mm);
    v.field("heading_from_deg", heading_from_deg);
    v.field("looks", looks);
    v.field("refused", refused);
  }
};

/// Looks without a pose, while the needle was driven over the dish.
struct RefusalFigures {
  Measured share;
  double cell_mm = 0.0;              ///< side of a square
  double heading_bin_deg = 0.0;      ///< width of a bin of headings
  std::vector<RefusalBin> cells;     ///< where there were looks
  std::vector<RefusalBin> headings;  ///< all around
  std::map<std::string, std::int64_t> reasons;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("share", share);
    v.field("cell_mm", cell_mm);
    v.field("heading_bin_deg", heading_bin_deg);
    v.field("cells", cells);
    v.field("headings", headings);
    v.field("reasons", reasons);
  }
};

/// From a pulse being asked for to the first image that shows motion.
struct LatencyFigures {
  Measured ms;
  double resolution_ms = 0.0;  ///< time from look to look: what one pulse alone tells
  std::int64_t unseen = 0;     ///< pulses without motion that was seen

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("ms", ms);
    v.field("resolution_ms", resolution_ms);
    v.field("unseen", unseen);
  }
};

/// The same pulse from like starts. Scatters are per axis.
struct SamePulseFigures {
  Measured step_mm;        ///< mean length of what it does
  Measured all_mm;         ///< scatter about the mean
  Measured scatter_mm;     ///< what is left once the difference of the starts is taken off
  double explained = 0.0;  ///< share of the scatter, squared, that the starts explain
  Measured share_of_step;  ///< scatter_mm by step_mm

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("step_mm", step_mm);
    v.field("all_mm", all_mm);
    v.field("scatter_mm", scatter_mm);
    v.field("explained", explained);
    v.field("share_of_step", share_of_step);
  }
};

/// One coil; `why` says what of it was not measured, and why not.
struct CoilFigures {
  std::string name;
  std::optional<Measured> gain = {};            ///< reported current by the one that was asked for
  std::optional<Measured> rise_ms = {};         ///< from 10 to 90 %
  std::optional<Measured> skew_ms = {};         ///< at 50 %, after the mean of all coils
  std::optional<Measured> gain_by_motion = {};  ///< how strongly the needle answers, beside the mean coil
  std::optional<double> first_C = {}, last_C = {};
  std::string why;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("name", name);
    v.field("gain", gain);
    v.field("rise_ms", rise_ms);
    v.field("skew_ms", skew_ms);
    v.field("gain_by_motion", gain_by_motion);
    v.field("first_C", first_C);
    v.field("last_C", last_C);
    v.field("why", why);
  }
};

/// The weakest current that moves the needle at a place; absent where none did.
struct BreakawayPlace {
  double x_mm = 0.0, y_mm = 0.0;
  std::optional<double> current_A = {};
  double tried_up_to_A = 0.0;
  std::int64_t pulses = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("x_mm", x_mm);
    v.field("y_mm", y_mm);
    v.field("current_A", current_A);
    v.field("tried_up_to_A", tried_up_to_A);
    v.field("pulses", pulses);
  }
};

/// Weak pulses of one strength at all places.
struct StepLevel {
  double current_A = 0.0;
  std::int64_t n = 0, moved = 0;
  double step_mm = 0.0;     ///< mean length of what they do where the start is known
  double scatter_mm = 0.0;  ///< per axis, about that, without the sensor's part

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("current_A", current_A);
    v.field("n", n);
    v.field("moved", moved);
    v.field("step_mm", step_mm);
    v.field("scatter_mm", scatter_mm);
  }
};

/// Stick-slip: what weak pulses do.
struct StickSlipFigures {
  std::optional<Measured> current_A = {};  ///< that moves the needle: mean over the places
  std::optional<Measured> spread = {};     ///< standard deviation over the places by that mean
  std::vector<BreakawayPlace> places;
  std::vector<StepLevel> levels;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("current_A", current_A);
    v.field("spread", spread);
    v.field("places", places);
    v.field("levels", levels);
  }
};

/// The error to expect: a short deployment to points of the bench itself, scored as deploy does, by the
/// distance to the target at the end of a trial. RMS are over trials that went to their end.
struct PointsFigures {
  std::string controller;  ///< "policy", "planner" or "baseline"
  double trial_s = 0.0;    ///< length of a trial
  Measured failed;         ///< share of the trials that were stopped early
  std::optional<Measured> sensed_rms_mm = {};
  std::optional<Measured> sensed_p95_mm = {};  ///< 95th percentile
  /// What true poses would show, as far as the still needle tells (experiments::points_figures).
  std::optional<Measured> rms_mm = {};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("controller", controller);
    v.field("trial_s", trial_s);
    v.field("failed", failed);
    v.field("sensed_rms_mm", sensed_rms_mm);
    v.field("sensed_p95_mm", sensed_p95_mm);
    v.field("rms_mm", rms_mm);
  }
};

/// One item, held against its bounds.
struct QualifiedItem {
  std::string item;
  std::optional<double> value = {};  ///< absent: not measured
  std::string unit;
  double good = 0.0, acceptable = 0.0;  ///< up to these
  std::string verdict;                  ///< "good", "acceptable", "mend" or "not measured"
  std::string why;                      ///< these bounds
  std::string mend;                     ///< what to do

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("item", item);
    v.field("value", value);
    v.field("unit", unit);
    v.field("good", good);
    v.field("acceptable", acceptable);
    v.field("verdict", verdict);
    v.field("why", why);
    v.field("mend", mend);
  }
};

/// Where a qualification was broken off, and gone on with later: meanwhile the bench may have changed.
struct QualificationGap {
  double after_min = 0.0;                  ///< of the bench
  double away_min = 0.0;                   ///< until it went on, by the clock on the wall
  std::vector<std::string> before;         ///< items that had ended
  std::optional<std::string> across = {};  ///< the item that was measured partly before and partly after it

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("after_min", after_min);
    v.field("away_min", away_min);
    v.field("before", before);
    v.field("across", across);
  }
};

/// `qualify.json`: what a bench can do. What was not measured is absent.
struct QualificationResult {
  static constexpr const char* kFile = "qualify.json";
  double dish_radius_mm = 0.0;
  double minutes = 0.0;                     ///< of the bench, without gaps
  std::optional<std::string> stopped = {};  ///< why it ended early
  std::vector<QualificationGap> gaps;
  std::optional<StillFigures> still = {}, still_at_end = {};
  std::optional<RefusalFigures> refusals = {};
  std::optional<LatencyFigures> latency = {};
  std::optional<SamePulseFigures> same_pulse = {};
  std::optional<Measured> step_change = {};  ///< of the same pulse, to the end, by its step
  std::vector<CoilFigures> coils;
  std::optional<StickSlipFigures> stick_slip = {};
  std::optional<PointsFigures> points = {};
  std::vector<QualifiedItem> items;
  std::string mend_first;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("dish_radius_mm", dish_radius_mm);
    v.field("minutes", minutes);
    v.field("stopped", stopped);
    v.field("gaps", gaps);
    v.field("still", still);
    v.field("still_at_end", still_at_end);
    v.field("refusals", refusals);
    v.field("latency", latency);
    v.field("same_pulse", same_pulse);
    v.field("step_change", step_change);
    v.field("coils", coils);
    v.field("stick_slip", stick_slip);
    v.field("points", points);
    v.field("items", items);
    v.field("mend_first", mend_first);
  }
};

}  // namespace lodestone::runs
