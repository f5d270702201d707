#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/json.h"
#include "lodestone/experiments/qualification_statistics.h"
#include "lodestone/experiments/refusal_map.h"
#include "lodestone/experiments/stick_slip.h"
#include "lodestone/runs/qualification_result.h"

namespace lodestone::experiments {

/// How far the weak pulses are.
struct WeakPulsesProgress {
  std::int64_t place = 0, level = 0;
  std::int64_t far_levels = 0;  ///< in a row whose pulses have all moved the needle far

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("place", place);
    v.field("level", level);
    v.field("far_levels", far_levels);
  }
};

/// `state.json`: what a qualification has measured, and where it is. It is what goes on with it.
struct QualificationState {
  static constexpr const char* kFile = "/state.json";
  double passed_s = 0.0;    ///< of the bench
  double saved_s = 0.0;     ///< since 1970
  std::int64_t item = 0;    ///< how many have ended
  std::int64_t pieces = 0;  ///< of the next one that were tried
  std::vector<runs::QualificationGap> gaps;

  std::optional<runs::StillFigures> still, still_at_end;
  std::vector<double> first_C, last_C;
  std::vector<std::vector<CurrentRise>> rises;  ///< by coil
  std::int64_t reports = 0;                     ///< of a current while its coil was on
  std::vector<PulseMotion> early, late;         ///< the same pulse
  std::vector<double> moved_s, looks_s;         ///< until motion after pulses, and from look to look
  std::int64_t unseen = 0;
  WeakPulsesProgress weak_progress;
  std::vector<WeakPulse> weak;
  RefusalCounts refusals;
  std::vector<double> points_mm;   ///< sensed distances to the targets at the ends of trials
  std::int64_t points_failed = 0;  ///< trials that were stopped early

  common::Json bench;  ///< a virtual one, as it was; null where only the bench itself knows

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("passed_s", passed_s);
    v.field("saved_s", saved_s);
    v.field("item", item);
    v.field("pieces", pieces);
    v.field("gaps", gaps);
    v.field("still", still);
    v.field("still_at_end", still_at_end);
    v.field("first_C", first_C);
    v.field("last_C", last_C);
    v.field("rises", rises);
    v.field("reports", reports);
    v.field("early", early);
    v.field("late", late);
    v.field("moved_s", moved_s);
    v.field("looks_s", looks_s);
    v.field("unseen", unseen);
    v.field("weak_progress", weak_progress);
    v.field("weak", weak);
    v.field("refusals", refusals);
    v.field("points_mm", points_mm);
    v.field("points_failed", points_failed);
    v.field("bench", bench);
  }
};

}  // namespace lodestone::experiments
