#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/data/dataset.h"

namespace lodestone::data {

enum class OnError { kAbort, kSkip };
inline std::vector<std::string> names_of(OnError) { return {"abort", "skip"}; }
enum class Impossible { kLeaveOut, kKeep };
inline std::vector<std::string> names_of(Impossible) { return {"leave_out", "keep"}; }
enum class PositionUnit { kMm, kM };
inline std::vector<std::string> names_of(PositionUnit) { return {"mm", "m"}; }
enum class AngleUnit { kRad, kDeg };
inline std::vector<std::string> names_of(AngleUnit) { return {"rad", "deg"}; }

/// How foreign recordings are read. Two layouts are known, told apart by their header (any column order,
/// further columns are ignored):
///
/// "pulses": coil, drive_percent, x_before_mm, y_before_mm, x_after_mm, y_after_mm. One row is one pulse of
///   one coil (+x, -x, +y or -y; drive in percent of its range). Rows that start exactly where the row before
///   ended form one episode, all others are episodes of one step.
///
/// "lab log": camera_frame_number, measured_current_filtered_{north,south,east,west} in A, localization_x,
///   localization_y, localization_angle. One row is one control step; its currents act between this row and
///   the next, and an episode ends where the frame number does not go on by `frame_step`. Taken for granted:
///   east is coil +x, west -x, north +y, south -y; the angle is that of the tail-to-head direction,
///   counter-clockwise from +x unless `y_down`.
struct CsvImportConfig {
  std::int64_t seed = 0;
  std::int64_t threads = 0;
  OnError on_error = OnError::kAbort;
  std::int64_t max_reported = 20;
  Impossible impossible = Impossible::kLeaveOut;
  bool plausible = true;
  double control_period_s = 0.0;
  PositionUnit position_unit = PositionUnit::kMm;
  AngleUnit angle_unit = AngleUnit::kRad;
  double centre_x = 0.0;
  double centre_y = 0.0;
  bool y_down = false;
  std::int64_t frame_step = 1;
  double current_noise_A = 0.05;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed written into the dataset; importing draws nothing");
    v.field("threads", threads, "", "importing uses one thread; taken so that every verb takes it",
            {0, 1024});
    v.field("on_error", on_error, "", "what a malformed row does");
    v.field("max_reported", max_reported, "rows", "skipped rows that are reported one by one", {0, 1000000});
    v.field(
        "impossible", impossible, "",
        "what is done with positions where nothing can be, outside the dish or, where that is not known, far "
        "beyond all others: a glitch of the camera");
    v.field("plausible", plausible, "",
            "refuse sizes and directions that cannot be; false takes them as they are");
    v.field(
        "control_period_s", control_period_s, "s",
        "time between two rows of a recording, or with --map the length of a pulse; 0: 0.3 s, or with --map "
        "as recorded",
        {0.0, 60.0});
    v.field("position_unit", position_unit, "", "lab log: unit of the position");
    v.field("angle_unit", angle_unit, "", "lab log: unit of the angle");
    v.field("centre_x", centre_x, "position_unit", "lab log: dish centre in the log's own coordinates",
            {-1e6, 1e6});
    v.field("centre_y", centre_y, "position_unit", "lab log: dish centre in the log's own coordinates",
            {-1e6, 1e6});
    v.field("y_down", y_down, "", "lab log: its y axis points to the south coil, as in image coordinates");
    v.field("frame_step", frame_step, "frames", "lab log: frame numbers from one control step to the next",
            {1, 100000});
    v.retired("max_current_A", "rig.coils.max_current_A");
    v.retired("dish_radius_m", "rig.dish.radius_m");
    v.field("current_noise_A", current_noise_A, "A", "lab log: smaller measured currents count as zero",
            {0.0, 10.0});
  }

  // No keys: the rig's.
  double max_current_A = 0.0;  ///< lab log: largest current of a coil; actions are scaled by it
  double dish_radius_m = 0.0;  ///< lab log: inner radius of the dish
  double full_drive_A = 0.0;   ///< --map: current of 100 per cent; 0: not known
  common::Json rig;            ///< lab log: description of the rig, kept with the data
};

/// What an import found beside its dataset.
struct CsvImportResult {
  Dataset dataset;
  std::string layout;                   ///< "pulses" or "lab log"
  std::int64_t rows = 0;                ///< data rows read, blank lines apart
  std::int64_t skipped = 0;             ///< malformed rows left out (on_error = skip)
  std::int64_t unpaired = 0;            ///< lab log: rows without a row after them, on each side of a gap
  std::vector<std::string> problems;    ///< the first max_reported skipped rows: file:line: column: fault
  std::vector<std::string> impossible;  ///< positions where nothing can be: file:line: where
};

/// Reads a foreign CSV file (BOM, CRLF, quotes and blank lines are accepted). Throws DataError naming file,
/// line and column at the first malformed row, or with on_error = skip leaves such rows out; also when the
/// header fits no known layout, no transition is left, or with `plausible` what is read cannot be
/// (plausibility.h).
CsvImportResult import_csv(const std::string& path, const CsvImportConfig& config);

}  // namespace lodestone::data
