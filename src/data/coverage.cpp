#include "lodestone/data/coverage.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::data {
namespace {

/// Cell of `t` in [0, 1] among `cells`.
std::size_t cell_of(double t, std::int64_t cells) {
  const auto index = static_cast<std::int64_t>(std::floor(t * static_cast<double>(cells)));
  return static_cast<std::size_t>(std::clamp<std::int64_t>(index, 0, cells - 1));
}

bool in_dish(std::int64_t column, std::int64_t row, std::int64_t cells) {
  const auto centre = [cells](std::int64_t i) {
    return (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(cells) - 1.0;
  };
  return std::hypot(centre(column), centre(row)) <= 1.0;
}

}  // namespace

Coverage measure_coverage(const Dataset& dataset, const CoverageConfig& config) {
  const TransitionTable table = flatten(dataset);
  const bool pose = dataset.info.layout == StateLayout::kPose;
  const std::int64_t p = config.position_cells;
  const std::int64_t h = pose ? config.heading_cells : 1;
  const std::int64_t l = config.drive_levels;
  Coverage result;
  result.workspace_radius_m = dataset.info.workspace_radius_m;
  result.position_cells = p;
  result.position_counts.assign(static_cast<std::size_t>(p * p), -1);
  for (std::int64_t row = 0; row < p; ++row)
    for (std::int64_t column = 0; column < p; ++column)
      if (in_dish(column, row, p)) {
        result.position_counts[static_cast<std::size_t>(row * p + column)] = 0;
        result.cells += h * l;
      }
  result.heading_counts.assign(static_cast<std::size_t>(h), 0);
  result.drive_counts.assign(static_cast<std::size_t>(l), 0);

  std::vector<std::int64_t> counts(static_cast<std::size_t>(p * p * h * l), 0);
  const double diameter_m = 2.0 * dataset.info.workspace_radius_m;
  for (std::int64_t i = 0; i < table.size(); ++i) {
    const double* state = &table.state[static_cast<std::size_t>(i * table.state_size)];
    const double* action = &table.action[static_cast<std::size_t>(i * table.action_size)];
    const double x = state[0] / diameter_m + 0.5;
    const double y = state[1] / diameter_m + 0.5;
    const double drive = strongest(action, table.action_size) / dataset.info.action_scale;
    const std::size_t heading =
        pose ? cell_of((geometry::wrap_angle(state[2]) + geometry::kPi) / (2.0 * geometry::kPi), h)
             : std::size_t{0};
    const std::size_t level = cell_of(drive, l);
    ++result.transitions;
    ++result.heading_counts[heading];
    ++result.drive_counts[level];
    if (x < 0.0 || x >= 1.0 || y < 0.0 || y >= 1.0) continue;
    const std::size_t position = cell_of(y, p) * static_cast<std::size_t>(p) + cell_of(x, p);
    if (result.position_counts[position] < 0) continue;
    ++result.position_counts[position];
    ++counts[(position * static_cast<std::size_t>(h) + heading) * static_cast<std::size_t>(l) + level];
  }

  const double total = static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
  double entropy = 0.0;
  for (const std::int64_t count : counts) {
    if (count == 0) continue;
    ++result.visited;
    const double fraction = static_cast<double>(count) / total;
    entropy -= fraction * std::log(fraction);
  }
  result.fraction = static_cast<double>(result.visited) / static_cast<double>(result.cells);
  result.evenness = result.cells > 1 ? entropy / std::log(static_cast<double>(result.cells)) : 1.0;
  return result;
}

void Coverage::validate() const {
  constexpr std::int64_t kMostCells = 200;  // along a diameter, as CoverageConfig allows
  if (position_cells < 0 || position_cells > kMostCells ||
      static_cast<std::int64_t>(position_counts.size()) != position_cells * position_cells)
    throw common::DataError("coverage: position_counts holds " + std::to_string(position_counts.size()) +
                            " numbers, expected position_cells squared");
  if (!(workspace_radius_m >= 0.0 && workspace_radius_m <= 1.0))
    throw common::DataError("coverage: workspace_radius_m is " + fmt::format("{:g}", workspace_radius_m) +
                            ", must be within 0 .. 1");
}

}  // namespace lodestone::data
