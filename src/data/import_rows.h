#pragma once

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "impossible_rows.h"
#include "lodestone/common/csv_table.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::data {

/// What every importer does with rows.

/// More of them mean a wrong unit or centre, not glitches.
constexpr double kMostImpossible = 0.05;
constexpr double kFullDrivePercent = 100.0;
/// A measured current may overshoot the set one a little; further off the row is taken for a fault.
constexpr double kCurrentMargin = 1.2;
constexpr double kLargestAngle = 1e6;  ///< rad or degrees; more turns than a log could count

/// A number of a cell with a bound to both sides, beyond which it is garbage.
inline double number_within(const common::CsvTable& table, std::size_t column, double bound) {
  const double value = table.number(column);
  if (std::abs(value) > bound) table.fail(column, fmt::format("within {:g} .. {:g}", -bound, bound));
  return value;
}

/// Runs `read` on every row, and settles what a malformed one does.
template <class Read, class OnSkip>
void for_each_row(common::CsvTable& table, const CsvImportConfig& config, CsvImportResult& result,
                  const Read& read, const OnSkip& on_skip) {
  while (table.next()) {
    ++result.rows;
    try {
      table.check_width();
      read();
    } catch (const common::RowError& error) {
      if (config.on_error != OnError::kSkip)
        throw common::DataError(std::string(error.what()) + " (--on-error skip leaves such rows out)");
      ++result.skipped;
      if (static_cast<std::int64_t>(result.problems.size()) < config.max_reported)
        result.problems.emplace_back(error.what());
      on_skip();
    }
  }
}

/// Episodes as they are read, and the line of the file that each observation comes from.
class Recording {
 public:
  explicit Recording(Dataset& dataset) : dataset_(dataset) {}

  const std::vector<double>& seen() const { return episode_.observations; }
  template <std::size_t S>
  void observe(const std::array<double, S>& state, std::int64_t line) {
    episode_.observations.insert(episode_.observations.end(), state.begin(), state.end());
    lines_.push_back(line);
  }
  void act(const std::array<double, 2>& action) {
    episode_.actions.insert(episode_.actions.end(), action.begin(), action.end());
    episode_.terminations.push_back(0);
    episode_.truncations.push_back(0);
    episode_.zero_current.push_back(action[0] == 0.0 && action[1] == 0.0 ? 1 : 0);
  }
  /// Ends an episode: a recording never ends by itself, it is cut.
  void cut() {
    if (episode_.length() > 0) {
      episode_.truncations.back() = 1;
      dataset_.episodes.push_back(std::move(episode_));
      lines_of_episodes_.push_back(std::move(lines_));
    }
    episode_ = Episode{};
    lines_.clear();
  }
  const std::vector<std::vector<std::int64_t>>& lines() const { return lines_of_episodes_; }

 private:
  Dataset& dataset_;
  Episode episode_;
  std::vector<std::int64_t> lines_;
  std::vector<std::vector<std::int64_t>> lines_of_episodes_;
};

/// Takes out what lies beyond the limit, and says where it stood. `remedy`: what to correct where it is too
/// much.
inline void leave_out_impossible(CsvImportResult& result, const Recording& recording, double limit_m,
                                 const std::string& path, const std::string& remedy) {
  const auto found = separate_impossible(result.dataset, recording.lines(), limit_m);
  if (static_cast<double>(found.size()) > kMostImpossible * static_cast<double>(result.rows))
    throw common::DataError(path + ": " + std::to_string(found.size()) + " of " +
                            std::to_string(result.rows) + " positions lie more than " +
                            fmt::format("{:g}", limit_m * geometry::kMmPerM) +
                            " mm from the centre, the first one in line " +
                            std::to_string(found.front().line) + ": correct " + remedy);
  for (const ImpossiblePosition& position : found)
    result.impossible.push_back(
        fmt::format("{}:{}: a position {:.6g} mm from the centre, where nothing can be (limit {:.6g} mm)",
                    path, position.line, position.radius_m * geometry::kMmPerM, limit_m * geometry::kMmPerM));
}

}  // namespace lodestone::data
