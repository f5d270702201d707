#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace lodestone::runs {

/// `adaptation.json` of adapt: what came of it.
struct Adaptation {
  static constexpr const char* kFile = "adaptation.json";
  std::string from;                            ///< folder of the simulator that it began with; empty: nothing
  std::int64_t pulses = 0;                     ///< recorded
  double rig_minutes = 0.0;                    ///< that they take
  std::int64_t placements = 0;                 ///< of the needle by the operator meanwhile
  std::int64_t held_back = 0;                  ///< pulses with current that no model learned from
  std::optional<double> log_drive_gain;        ///< of the rig, where that simulator's is 0
  std::optional<double> log_drive_gain_sigma;  ///< its standard deviation
  /// Mean over the held-back pulses of the natural logarithm of their density beside an outlier's: by the
  /// simulator that learned, by the one that it began with, and by that one at the rig's gain.
  double log_likelihood = 0.0;
  std::optional<double> log_likelihood_before, log_likelihood_with_gain;
  /// The first less the last, and its 95 % interval by bootstrap over episodes.
  std::optional<double> better_by, better_by_low, better_by_high;
  bool kept = true;  ///< whether `model` is the one that learned: the interval lies above 0
  bool rolled_back = false;
  double seconds = 0.0;  ///< of computing, driving a virtual rig included

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("from", from);
    v.field("pulses", pulses);
    v.field("rig_minutes", rig_minutes);
    v.field("placements", placements);
    v.field("held_back", held_back);
    v.field("log_drive_gain", log_drive_gain);
    v.field("log_drive_gain_sigma", log_drive_gain_sigma);
    v.field("log_likelihood", log_likelihood);
    v.field("log_likelihood_before", log_likelihood_before);
    v.field("log_likelihood_with_gain", log_likelihood_with_gain);
    v.field("better_by", better_by);
    v.field("better_by_low", better_by_low);
    v.field("better_by_high", better_by_high);
    v.field("kept", kept);
    v.field("rolled_back", rolled_back);
    v.field("seconds", seconds);
  }
};

}  // namespace lodestone::runs
