#include "lodestone/data/csv_import.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "import_rows.h"
#include "lodestone/common/csv_table.h"
#include "lodestone/common/named.h"
#include "lodestone/common/shown.h"
#include "lodestone/common/spelling.h"
#include "lodestone/common/statistics.h"
#include "lodestone/data/plausibility.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::data {
namespace {

using common::CsvTable;
using common::DataError;
using common::joined;

const std::vector<std::string> kPulseColumns = {"coil",        "drive_percent", "x_before_mm",
                                                "y_before_mm", "x_after_mm",    "y_after_mm"};
const std::vector<std::string> kLogColumns = {"camera_frame_number",
                                              "measured_current_filtered_north",
                                              "measured_current_filtered_south",
                                              "measured_current_filtered_east",
                                              "measured_current_filtered_west",
                                              "localization_x",
                                              "localization_y",
                                              "localization_angle"};

constexpr const char* kRemedy = "position_unit, centre_x and centre_y, or the rig's dish";
// Where the dish is not known, positions beyond this many workspace radii cannot be; with fewer positions
// than this, nobody can tell.
constexpr double kUnknownDishMargin = 1.5;
constexpr std::size_t kFewestPositions = 100;
// The recorded sphere's dish is not known: the workspace is the radius that this fraction of positions lies
// in.
constexpr double kWorkspaceQuantile = 0.995;

/// Distances from the centre, of all observations.
std::vector<double> radii_of(const std::vector<Episode>& episodes) {
  std::vector<double> radii_m;
  for (const Episode& episode : episodes)
    for (std::size_t i = 0; i < episode.observations.size(); i += 2)
      radii_m.push_back(std::hypot(episode.observations[i], episode.observations[i + 1]));
  return radii_m;
}

void read_pulses(CsvTable& table, const CsvImportConfig& config, const std::string& path,
                 CsvImportResult& result) {
  const std::size_t coil = table.column("coil");
  const std::size_t drive = table.column("drive_percent");
  const std::array<std::size_t, 4> position = {table.column("x_before_mm"), table.column("y_before_mm"),
                                               table.column("x_after_mm"), table.column("y_after_mm")};
  result.dataset.info.layout = StateLayout::kPosition;
  Recording recording(result.dataset);
  const auto read = [&] {
    static const std::array<std::string, 4> kCoils = {"+x", "-x", "+y", "-y"};
    const auto found = std::find(kCoils.begin(), kCoils.end(), table.text(coil));
    if (found == kCoils.end()) table.fail(coil, "one of +x, -x, +y, -y");
    const auto index = static_cast<std::size_t>(found - kCoils.begin());
    const double percent = table.number(drive);
    if (percent < 0.0 || percent > kFullDrivePercent) table.fail(drive, "a percentage between 0 and 100");
    std::array<double, 4> at{};
    for (std::size_t i = 0; i < 4; ++i)
      at[i] = number_within(table, position[i], kFarthestGlitch_m * geometry::kMmPerM) / geometry::kMmPerM;

    const std::vector<double>& seen = recording.seen();
    if (seen.empty() || seen[seen.size() - 2] != at[0] || seen[seen.size() - 1] != at[1]) {
      recording.cut();
      recording.observe<2>({at[0], at[1]}, table.line());
    }
    std::array<double, 2> action{};
    action[index / 2] = percent == 0.0 ? 0.0 : index % 2 == 0 ? percent : -percent;
    recording.act(action);
    recording.observe<2>({at[2], at[3]}, table.line());
  };
  for_each_row(table, config, result, read, [&] { recording.cut(); });
  recording.cut();
  const std::vector<double> radii_m = radii_of(result.dataset.episodes);
  if (radii_m.size() >= kFewestPositions && config.impossible == Impossible::kLeaveOut)
    leave_out_impossible(result, recording,
                         kUnknownDishMargin * common::percentile(radii_m, kWorkspaceQuantile), path, kRemedy);

  DatasetInfo& info = result.dataset.info;
  info.layout = StateLayout::kPosition;
  info.action_unit = "percent";
  info.action_scale = kFullDrivePercent;
  info.workspace_radius_m = common::percentile(radii_of(result.dataset.episodes), kWorkspaceQuantile);
  info.one_axis_at_a_time = true;
}

/// One row of the lab's log, in the dish frame.
struct LogRow {
  double frame;
  std::array<double, 3> pose;
  std::array<double, 2> drive;
  double turned_rad;  // the heading as it stands
};

class LogReader {
 public:
  LogReader(const CsvTable& table, const CsvImportConfig& config) : table_(table), config_(config) {
    for (std::size_t i = 0; i < columns_.size(); ++i) columns_[i] = table.column(kLogColumns[i]);
  }

  LogRow read() const {
    LogRow row{};
    row.frame = table_.number(columns_[0]);
    if (row.frame != std::floor(row.frame)) table_.fail(columns_[0], "a whole number");
    row.drive = {signed_drive(3, 4), signed_drive(1, 2)};
    const double metres = config_.position_unit == PositionUnit::kMm ? 1.0 / geometry::kMmPerM : 1.0;
    const double radians = config_.angle_unit == AngleUnit::kDeg ? geometry::kPi / 180.0 : 1.0;
    const double up = config_.y_down ? -1.0 : 1.0;
    const double farthest = kFarthestGlitch_m / metres;
    row.pose[0] = (number_within(table_, columns_[5], farthest) - config_.centre_x) * metres;
    row.pose[1] = up * (number_within(table_, columns_[6], farthest) - config_.centre_y) * metres;
    row.turned_rad = up * number_within(table_, columns_[7], kLargestAngle) * radians;
    row.pose[2] = geometry::wrap_angle(row.turned_rad);
    return row;
  }

  /// Of no row yet.
  LogSizes sizes() const {
    LogSizes sizes;
    sizes.largest_drive = config_.max_current_A;
    sizes.positions = fmt::format("localization_x and localization_y (position_unit = {})",
                                  common::name_of(config_.position_unit));
    sizes.heading_unit = common::name_of(config_.angle_unit);
    sizes.heading = fmt::format("localization_angle (angle_unit = {})", sizes.heading_unit);
    sizes.currents = "measured_current_filtered_north, _south, _east, _west";
    return sizes;
  }

 private:
  double current(std::size_t which) const {
    const double value = table_.number(columns_[which]);
    if (std::abs(value) <= config_.current_noise_A) return 0.0;
    if (value < 0.0 || value > kCurrentMargin * config_.max_current_A)
      table_.fail(columns_[which], "a current between 0 and " +
                                       std::to_string(kCurrentMargin * config_.max_current_A) +
                                       " A (see rig.coils.max_current_A)");
    return value;
  }

  double signed_drive(std::size_t plus, std::size_t minus) const {
    const double positive = current(plus);
    const double negative = current(minus);
    if (positive > 0.0 && negative > 0.0)
      table_.fail(columns_[minus], "0: the opposite coil (" + kLogColumns[plus] + " = " +
                                       table_.text(columns_[plus]) + ") is on as well");
    return positive - negative;
  }

  const CsvTable& table_;
  const CsvImportConfig& config_;
  std::array<std::size_t, 8> columns_{};
};

void read_log(CsvTable& table, const CsvImportConfig& config, const std::string& path,
              CsvImportResult& result) {
  const LogReader reader(table, config);
  Recording recording(result.dataset);
  LogSizes sizes = reader.sizes();
  std::optional<LogRow> before;
  const auto cut = [&] {
    if (before) ++result.unpaired;
    recording.cut();
    before.reset();
  };
  const auto read = [&] {
    const LogRow row = reader.read();
    if (before && row.frame - before->frame != static_cast<double>(config.frame_step)) cut();
    if (before) recording.act(before->drive);
    recording.observe(row.pose, table.line());
    sizes.see({row.pose[0], row.pose[1]}, config.dish_radius_m, table.line());
    sizes.most_turned_rad = std::max(sizes.most_turned_rad, std::abs(row.turned_rad));
    sizes.most_drive = std::max({sizes.most_drive, std::abs(row.drive[0]), std::abs(row.drive[1])});
    before = row;
  };
  for_each_row(table, config, result, read, cut);
  cut();
  if (config.plausible && sizes.rows > 0) check_sizes(sizes, config.dish_radius_m, path);
  if (config.impossible == Impossible::kLeaveOut)
    leave_out_impossible(result, recording, config.dish_radius_m, path, kRemedy);

  DatasetInfo& info = result.dataset.info;
  info.layout = StateLayout::kPose;
  info.action_unit = "A";
  info.action_scale = config.max_current_A;
  info.workspace_radius_m = config.dish_radius_m;
  info.rig = config.rig;
  const std::vector<Episode>& episodes = result.dataset.episodes;
  info.one_axis_at_a_time = std::none_of(episodes.begin(), episodes.end(), [](const Episode& e) {
    for (std::size_t t = 0; t < e.actions.size(); t += 2)
      if (e.actions[t] != 0.0 && e.actions[t + 1] != 0.0) return true;
    return false;
  });
}

}  // namespace

CsvImportResult import_csv(const std::string& path, const CsvImportConfig& config) {
  CsvTable table(path);
  CsvImportResult result;
  if (table.has_columns(kPulseColumns)) {
    result.layout = "pulses";
    read_pulses(table, config, path, result);
  } else if (table.has_columns(kLogColumns)) {
    result.layout = "lab log";
    read_log(table, config, path, result);
  } else {
    throw DataError(path + ":1: the header (" + common::shown(joined(table.header())) +
                    ") fits no known layout; known are pulses (" + joined(kPulseColumns) + ") and lab log (" +
                    joined(kLogColumns) + ")");
  }
  if (config.control_period_s > 0.0) result.dataset.info.control_period_s = config.control_period_s;
  result.dataset.info.seed = config.seed;
  result.dataset.info.source = path.substr(path.find_last_of('/') + 1);
  check_dataset(result.dataset, path);
  if (config.plausible) check_directions(result.dataset, path);
  return result;
}

}  // namespace lodestone::data
