#include "lodestone/data/mobility.h"

#include <algorithm>
#include <cmath>

namespace lodestone::data {
namespace {

constexpr double kMoved_m = 0.5e-3;
constexpr double kStrong = 0.5;  // of the largest drive

}  // namespace

Mobility measure_mobility(const Dataset& dataset, double cell_m) {
  const TransitionTable table = flatten(dataset);
  Mobility result;
  result.workspace_radius_m = dataset.info.workspace_radius_m;
  result.cell_m = cell_m;
  result.strong_A = kStrong * dataset.info.action_scale;
  const auto reach = static_cast<std::int64_t>(std::ceil(result.workspace_radius_m / cell_m));
  const std::int64_t side = 2 * reach + 1;
  std::vector<std::int64_t> place(static_cast<std::size_t>(side * side), -1);
  for (std::int64_t row = -reach; row <= reach; ++row)
    for (std::int64_t column = -reach; column <= reach; ++column) {
      MobilityCell cell;
      cell.x_m = static_cast<double>(column) * cell_m;
      cell.y_m = static_cast<double>(row) * cell_m;
      if (std::hypot(cell.x_m, cell.y_m) > result.workspace_radius_m) continue;
      place[static_cast<std::size_t>((row + reach) * side + column + reach)] =
          static_cast<std::int64_t>(result.cells.size());
      result.cells.push_back(cell);
    }
  for (std::int64_t i = 0; i < table.size(); ++i) {
    const double* from = &table.state[static_cast<std::size_t>(i * table.state_size)];
    const double* to = &table.next_state[static_cast<std::size_t>(i * table.state_size)];
    const double* drive = &table.action[static_cast<std::size_t>(i * table.action_size)];
    if (strongest(drive, table.action_size) < result.strong_A) continue;
    const std::int64_t column = std::llround(from[0] / cell_m) + reach;
    const std::int64_t row = std::llround(from[1] / cell_m) + reach;
    if (column < 0 || row < 0 || column >= side || row >= side) continue;
    const std::int64_t index = place[static_cast<std::size_t>(row * side + column)];
    if (index < 0) continue;
    MobilityCell& cell = result.cells[static_cast<std::size_t>(index)];
    const double way_m = std::hypot(to[0] - from[0], to[1] - from[1]);
    ++cell.pulses;
    cell.moved += way_m > kMoved_m ? 1.0 : 0.0;
    cell.mean_mm += 1e3 * way_m;
  }
  for (MobilityCell& cell : result.cells) {
    if (cell.pulses == 0) continue;
    cell.moved /= static_cast<double>(cell.pulses);
    cell.mean_mm /= static_cast<double>(cell.pulses);
  }
  return result;
}

}  // namespace lodestone::data
