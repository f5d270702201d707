#include "lodestone/data/csv_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "csv_table.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::data {
namespace {

using common::DataError;

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

constexpr double kMmPerM = 1000.0;
constexpr double kFullDrivePercent = 100.0;
// A measured current may overshoot the set one a little; further off the row is taken for a fault.
constexpr double kCurrentMargin = 1.2;
// Positions beyond this many dish radii mean a wrong unit or centre, not a needle near the wall.
constexpr double kPositionMargin = 1.5;
// The recorded sphere's dish is not known: the workspace is the radius that this fraction of positions lies
// in.
constexpr double kWorkspaceQuantile = 0.995;

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Runs `read` on every row, and settles what a malformed one does.
template <class Read, class OnSkip>
void for_each_row(CsvTable& table, const CsvImportConfig& config, CsvImportResult& result, const Read& read,
                  const OnSkip& on_skip) {
  while (table.next()) {
    ++result.rows;
    try {
      table.check_width();
      read();
    } catch (const RowError& error) {
      if (config.on_error != "skip")
        throw DataError(std::string(error.what()) + " (--on-error skip leaves such rows out)");
      ++result.skipped;
      if (static_cast<std::int64_t>(result.problems.size()) < config.max_reported)
        result.problems.emplace_back(error.what());
      on_skip();
    }
  }
}

void append_step(Episode& episode, const std::array<double, 2>& action) {
  episode.actions.insert(episode.actions.end(), action.begin(), action.end());
  episode.terminations.push_back(0);
  episode.truncations.push_back(0);
  episode.zero_current.push_back(action[0] == 0.0 && action[1] == 0.0 ? 1 : 0);
}

/// Ends an episode: a recording never ends by itself, it is cut.
void close(Episode& episode, std::vector<Episode>& episodes) {
  if (episode.length() > 0) {
    episode.truncations.back() = 1;
    episodes.push_back(std::move(episode));
  }
  episode = Episode{};
}

double radius_of_data(const std::vector<Episode>& episodes) {
  std::vector<double> radii;
  for (const Episode& episode : episodes)
    for (std::size_t i = 0; i < episode.observations.size(); i += 2)
      radii.push_back(std::hypot(episode.observations[i], episode.observations[i + 1]));
  if (radii.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(kWorkspaceQuantile * static_cast<double>(radii.size() - 1));
  std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(rank), radii.end());
  return radii[rank];
}

void read_pulses(CsvTable& table, const CsvImportConfig& config, CsvImportResult& result) {
  const std::size_t coil = table.column("coil");
  const std::size_t drive = table.column("drive_percent");
  const std::array<std::size_t, 4> position = {table.column("x_before_mm"), table.column("y_before_mm"),
                                               table.column("x_after_mm"), table.column("y_after_mm")};
  Episode episode;
  std::vector<Episode>& episodes = result.dataset.episodes;
  const auto read = [&] {
    static const std::array<std::string, 4> kCoils = {"+x", "-x", "+y", "-y"};
    const auto found = std::find(kCoils.begin(), kCoils.end(), table.text(coil));
    if (found == kCoils.end()) table.fail(coil, "one of +x, -x, +y, -y");
    const auto index = static_cast<std::size_t>(found - kCoils.begin());
    const double percent = table.number(drive);
    if (percent < 0.0 || percent > kFullDrivePercent) table.fail(drive, "a percentage between 0 and 100");
    std::array<double, 4> at{};
    for (std::size_t i = 0; i < 4; ++i) at[i] = table.number(position[i]) / kMmPerM;

    const std::vector<double>& seen = episode.observations;
    if (seen.empty() || seen[seen.size() - 2] != at[0] || seen[seen.size() - 1] != at[1]) {
      close(episode, episodes);
      episode.observations = {at[0], at[1]};
    }
    std::array<double, 2> action{};
    action[index / 2] = percent == 0.0 ? 0.0 : index % 2 == 0 ? percent : -percent;
    append_step(episode, action);
    episode.observations.insert(episode.observations.end(), {at[2], at[3]});
  };
  for_each_row(table, config, result, read, [&] { close(episode, episodes); });
  close(episode, episodes);

  DatasetInfo& info = result.dataset.info;
  info.layout = StateLayout::kPosition;
  info.action_unit = "percent";
  info.action_scale = kFullDrivePercent;
  info.workspace_radius_m = radius_of_data(episodes);
  info.one_axis_at_a_time = true;
}

/// One row of the lab's log, in the dish frame.
struct LogRow {
  double frame;
  std::array<double, 3> pose;
  std::array<double, 2> drive;
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
    const double metres = config_.position_unit == "mm" ? 1.0 / kMmPerM : 1.0;
    const double radians = config_.angle_unit == "deg" ? M_PI / 180.0 : 1.0;
    const double up = config_.y_down ? -1.0 : 1.0;
    row.pose[0] = (table_.number(columns_[5]) - config_.centre_x) * metres;
    row.pose[1] = up * (table_.number(columns_[6]) - config_.centre_y) * metres;
    row.pose[2] = geometry::wrap_angle(up * table_.number(columns_[7]) * radians);
    const double radius = std::hypot(row.pose[0], row.pose[1]);
    if (radius > kPositionMargin * config_.dish_radius_m)
      table_.fail(columns_[5], "in the dish: it lies " + std::to_string(radius * kMmPerM) +
                                   " mm from the centre, the dish has a radius of " +
                                   std::to_string(config_.dish_radius_m * kMmPerM) +
                                   " mm (see position_unit, centre_x, centre_y)");
    return row;
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

void read_log(CsvTable& table, const CsvImportConfig& config, CsvImportResult& result) {
  const LogReader reader(table, config);
  std::vector<Episode>& episodes = result.dataset.episodes;
  Episode episode;
  std::optional<LogRow> before;
  const auto cut = [&] {
    if (before) ++result.unpaired;
    close(episode, episodes);
    before.reset();
  };
  const auto read = [&] {
    const LogRow row = reader.read();
    if (before && row.frame - before->frame != static_cast<double>(config.frame_step)) cut();
    if (before) append_step(episode, before->drive);
    episode.observations.insert(episode.observations.end(), row.pose.begin(), row.pose.end());
    before = row;
  };
  for_each_row(table, config, result, read, cut);
  cut();

  DatasetInfo& info = result.dataset.info;
  info.layout = StateLayout::kPose;
  info.action_unit = "A";
  info.action_scale = config.max_current_A;
  info.workspace_radius_m = config.dish_radius_m;
  info.rig = config.rig;
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
    read_pulses(table, config, result);
  } else if (table.has_columns(kLogColumns)) {
    result.layout = "lab log";
    read_log(table, config, result);
  } else {
    throw DataError(path + ":1: the header (" + joined(table.header()) +
                    ") fits no known layout; known are pulses (" + joined(kPulseColumns) + ") and lab log (" +
                    joined(kLogColumns) + ")");
  }
  result.dataset.info.control_period_s = config.control_period_s;
  result.dataset.info.seed = config.seed;
  result.dataset.info.source = path.substr(path.find_last_of('/') + 1);
  check_dataset(result.dataset, path);
  return result;
}

}  // namespace lodestone::data
