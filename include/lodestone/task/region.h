#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::task {

/// One recorded pulse with current.
struct Move {
  geometry::Vector2 from_m;
  geometry::Vector2 to_m;
};

/// How the reachable region is mapped.
struct RegionConfig {
  double cell_m = 0.004;
  std::int64_t least_arrivals = 3;
  double least_departures = 0.05;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("cell_m", cell_m, "m", "side of a cell of the map", {1e-4, 0.1});
    v.field("least_arrivals", least_arrivals, "", "pulses that must have brought the needle into a cell",
            {1, 1000000});
    v.field("least_departures", least_departures, "",
            "fraction of the pulses in a cell that must have taken the needle out of it", {0.0, 1.0});
  }
};

/// The part of the dish that the needle has been seen to come to and to get away from, as a map of square
/// cells. What is not in it are the paper's dead zones, and what was never visited.
class Region {
 public:
  using Cell = std::pair<std::int64_t, std::int64_t>;

  Region() = default;
  /// Cells that satisfy `config` and hang together with the one most moves went through.
  /// Throws ConfigError when none is left.
  Region(const std::vector<Move>& moves, const RegionConfig& config);

  /// All cells whose middle lies in a disc around the dish centre: where nothing was recorded.
  static Region disc(double radius_m, double cell_m);

  bool contains(const geometry::Vector2& position_m) const;
  /// Draws until a point lies inside. Throws ConfigError when ten thousand did not.
  geometry::Vector2 draw(const std::function<geometry::Vector2()>& draw_point) const;
  double area_m2() const;

  double cell_m() const { return cell_m_; }  ///< side of a cell
  /// The cell around a position, in the region or not, and its middle.
  Cell cell_of(const geometry::Vector2& position_m) const;
  geometry::Vector2 centre_m(const Cell& cell) const;
  /// Middles of the region's cells.
  std::vector<geometry::Vector2> centres_m() const;
  /// Which of those cells is around a position; nothing outside the region.
  std::optional<std::size_t> find(const geometry::Vector2& position_m) const;

  /// {"cell_m", "cells": [[ix, iy], ...]}, and back; throws DataError.
  common::Json json() const;
  static Region from_json(const common::Json& json);

 private:
  double cell_m_ = 0.004;
  std::vector<Cell> cells_;  // sorted
};

}  // namespace lodestone::task
