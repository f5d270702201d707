#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::data {

/// One row of a log. Its drive acts from here to the next row.
struct LogSample {
  double time_s = 0.0;
  geometry::Pose2 pose;
  geometry::Vector2 drive = geometry::Vector2::Zero();  ///< signed, of the axes x and y, in any unit
  std::int64_t line = 0;                                ///< of the file
};

/// How rows are cut into pulses.
struct CuttingRule {
  double period_s = 0.0;       ///< length of a step; 0: as recorded
  double on_s = 0.0;           ///< how long its current is on, and then off; 0: throughout
  double tolerance = 0.2;      ///< how far a pulse may be from it, as a fraction
  double longest_gap_s = 0.0;  ///< rows further apart are not connected; 0: see cut_pulses()
  double same_drive = 0.0;     ///< drives that differ by no more are the same
};

/// A stretch of time that is one step of the dataset, from row to row or between them.
struct CutPulse {
  double from_s = 0.0;
  double to_s = 0.0;
  geometry::Pose2 before, after;
  geometry::Vector2 drive = geometry::Vector2::Zero();  ///< zero: a rest
  std::int64_t line_before = 0, line_after = 0;         ///< the rows that are nearest
  bool follows = false;                                 ///< begins where the one before ended
};

enum class LeftOut { kOtherLength, kRemainder, kGap };
inline std::vector<std::string> names_of(LeftOut) {
  return {"not as long as a pulse", "what is left after whole pulses", "rows too far apart"};
}

/// Time that became no step, and why.
struct LeftOutSpan {
  LeftOut why = LeftOut::kOtherLength;
  double from_s = 0.0;
  double to_s = 0.0;
  std::int64_t line = 0;
};

struct CutLog {
  double spacing_s = 0.0;      ///< median time between rows
  double period_s = 0.0;       ///< of a step, as given or found
  double longest_gap_s = 0.0;  ///< as used
  std::vector<CutPulse> pulses;
  std::vector<LeftOutSpan> left_out;
  std::int64_t interpolated = 0;  ///< poses taken from between two rows
};

/// Cuts a log into pulses of one length T, and rests.
///
/// Rows further apart than `longest_gap_s` (default: one and a half median distances, but half a pulse at
/// least) are not connected. A stretch is rows one after the other with the same drive. One that lasts less
/// than 0.3 T is a current on its way and belongs to the next one, whose drive is not taken from it. A
/// stretch with current is cut every T, at the row there where one is within the tolerance, else between two
/// rows, with the pose interpolated; its end is the end of its last pulse where that is within the tolerance,
/// and what is left over is left out, as are stretches that are shorter than a pulse. Their drive is the mean
/// over time. A stretch without current is rests of T, the last one up to its end.
///
/// With `on_s` a stretch with current is one step where it is as long as that, and T after its beginning it
/// is over; the stretch without current that follows must last until then.
///
/// T as recorded is the length below which a quarter of the driven time lies, by stretches; with `on_s` the
/// time from one to the next, below which a quarter of them are.
///
/// `samples` ascend in time. Throws DataError where they hold no two rows or no current, or where T is beyond
/// 1 ms .. 60 s; messages begin with `place`.
CutLog cut_pulses(const std::vector<LogSample>& samples, const CuttingRule& rule, const std::string& place);

}  // namespace lodestone::data
