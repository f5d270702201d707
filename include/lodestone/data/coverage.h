#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// Cells that coverage counts in: position over the square around the dish, heading, and strength of the
/// drive.
struct CoverageConfig {
  std::int64_t position_cells = 10;  ///< cells along a diameter
  std::int64_t heading_cells = 8;    ///< over the full turn; 1 for a sphere
  std::int64_t drive_levels = 3;     ///< equal steps of the strongest number / action_scale from 0 to 1

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("position_cells", position_cells, "cells", "position cells along a diameter", {2, 200});
    v.field("heading_cells", heading_cells, "cells", "heading cells over the full turn", {1, 360});
    v.field("drive_levels", drive_levels, "levels", "levels of drive from 0 to the largest", {1, 100});
  }
};

/// How evenly the recorded rows with current cover what can be visited.
struct Coverage {
  std::int64_t transitions = 0;  ///< rows with current
  std::int64_t cells = 0;        ///< cells whose position lies in the dish
  std::int64_t visited = 0;
  double fraction = 0.0;  ///< visited / cells
  double evenness = 0.0;  ///< entropy of the visits over log(cells), 0 to 1
  double workspace_radius_m = 0.0;
  std::int64_t position_cells = 0;
  std::vector<std::int64_t> position_counts;  ///< [P, P], row 0 at the lowest y; -1 outside the dish
  std::vector<std::int64_t> heading_counts;   ///< from -pi
  std::vector<std::int64_t> drive_counts;     ///< from the weakest

  static constexpr const char* kFile = "coverage.json";  ///< in the folder of a recording
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("transitions", transitions);
    v.field("cells", cells);
    v.field("visited", visited);
    v.field("fraction", fraction);
    v.field("evenness", evenness);
    v.field("workspace_radius_m", workspace_radius_m);
    v.field("position_cells", position_cells);
    v.field("position_counts", position_counts);
    v.field("heading_counts", heading_counts);
    v.field("drive_counts", drive_counts);
  }
  /// Throws DataError when the counts do not fit the cells.
  void validate() const;
};

/// Counts rows with current; rows outside the dish count for no cell.
Coverage measure_coverage(const Dataset& dataset, const CoverageConfig& config = {});

}  // namespace lodestone::data
