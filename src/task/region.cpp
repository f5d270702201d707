#include "lodestone/task/region.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "lodestone/common/error.h"

namespace lodestone::task {
namespace {

constexpr double kLeastCell_m = 1e-4;
constexpr double kMostCell_m = 0.1;

}  // namespace

Region::Cell Region::cell_of(const geometry::Vector2& position_m) const {
  return {static_cast<std::int64_t>(std::floor(position_m.x() / cell_m_)),
          static_cast<std::int64_t>(std::floor(position_m.y() / cell_m_))};
}

Region::Region(const std::vector<Move>& moves, const RegionConfig& config) : cell_m_(config.cell_m) {
  struct Traffic {
    std::int64_t arrivals = 0, departures = 0, pulses = 0;
  };
  std::map<Cell, Traffic> traffic;
  for (const Move& move : moves) {
    const Cell from = cell_of(move.from_m);
    const Cell to = cell_of(move.to_m);
    ++traffic[from].pulses;
    if (from == to) continue;
    ++traffic[from].departures;
    ++traffic[to].arrivals;
  }
  std::set<Cell> left;
  const Cell* busiest = nullptr;
  std::int64_t most = -1;
  for (const auto& [cell, seen] : traffic) {
    if (seen.arrivals < config.least_arrivals ||
        static_cast<double>(seen.departures) < config.least_departures * static_cast<double>(seen.pulses))
      continue;
    left.insert(cell);
    if (seen.arrivals > most) {
      most = seen.arrivals;
      busiest = &cell;
    }
  }
  if (busiest == nullptr)
    throw common::ConfigError("no cell of " + std::to_string(1e3 * cell_m_) + " mm was reached " +
                              std::to_string(config.least_arrivals) +
                              " times in the data; use larger cells or record more");
  std::vector<Cell> open = {*busiest};
  left.erase(open.front());
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    cells_.push_back(cell);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto next = left.find({cell.first + dx, cell.second + dy});
        if (next == left.end()) continue;
        open.push_back(*next);
        left.erase(next);
      }
    }
  }
  std::sort(cells_.begin(), cells_.end());
}

Region Region::disc(double radius_m, double cell_m) {
  Region region;
  region.cell_m_ = cell_m;
  const auto most = static_cast<std::int64_t>(std::ceil(radius_m / cell_m));
  for (std::int64_t x = -most; x <= most; ++x)
    for (std::int64_t y = -most; y <= most; ++y)
      if (region.centre_m({x, y}).norm() <= radius_m) region.cells_.emplace_back(x, y);
  return region;  // sorted, as they were made
}

bool Region::contains(const geometry::Vector2& position_m) const {
  return std::binary_search(cells_.begin(), cells_.end(), cell_of(position_m));
}

geometry::Vector2 Region::draw(const std::function<geometry::Vector2()>& draw_point) const {
  constexpr int kTries = 10000;
  for (int i = 0; i < kTries; ++i) {
    const geometry::Vector2 point_m = draw_point();
    if (contains(point_m)) return point_m;
  }
  throw common::ConfigError(
      "no point of the disc lies in the reachable region; enlarge the radius it is drawn from");
}

geometry::Vector2 Region::centre_m(const Cell& cell) const {
  return {(static_cast<double>(cell.first) + 0.5) * cell_m_,
          (static_cast<double>(cell.second) + 0.5) * cell_m_};
}

std::vector<geometry::Vector2> Region::centres_m() const {
  std::vector<geometry::Vector2> centres;
  for (const Cell& cell : cells_) centres.push_back(centre_m(cell));
  return centres;
}

std::optional<std::size_t> Region::find(const geometry::Vector2& position_m) const {
  const Cell cell = cell_of(position_m);
  const auto found = std::lower_bound(cells_.begin(), cells_.end(), cell);
  if (found == cells_.end() || *found != cell) return std::nullopt;
  return static_cast<std::size_t>(found - cells_.begin());
}

double Region::area_m2() const { return static_cast<double>(cells_.size()) * cell_m_ * cell_m_; }

common::Json Region::json() const { return {{"cell_m", cell_m_}, {"cells", cells_}}; }

Region Region::from_json(const common::Json& json) {
  Region region;
  try {
    region.cell_m_ = json.at("cell_m").get<double>();
    region.cells_ = json.at("cells").get<std::vector<Cell>>();
  } catch (const common::Json::exception& error) {
    throw common::DataError(std::string("map of the reachable region is malformed: ") + error.what());
  }
  if (region.cells_.empty()) throw common::DataError("map of the reachable region holds no cell");
  if (!(region.cell_m_ >= kLeastCell_m && region.cell_m_ <= kMostCell_m))
    throw common::DataError("map of the reachable region: cell_m = " + common::shown_json(json["cell_m"]) +
                            " must be within 0.0001 .. 0.1");
  std::sort(region.cells_.begin(), region.cells_.end());
  return region;
}

}  // namespace lodestone::task
