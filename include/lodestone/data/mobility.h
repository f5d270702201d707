#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// What strong pulses do to a needle that lies in one square of the dish.
struct MobilityCell {
  double x_m = 0.0;  ///< its centre
  double y_m = 0.0;
  std::int64_t pulses = 0;
  double moved = 0.0;  ///< share of them that moved it by more than 0.5 mm
  double mean_mm = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("x_m", x_m);
    v.field("y_m", y_m);
    v.field("pulses", pulses);
    v.field("moved", moved);
    v.field("mean_mm", mean_mm);
  }
};

/// Where a recording says that the needle comes, and how far a strong pulse takes it from there: the control
/// zones of the paper's Fig. 2.
struct Mobility {
  double workspace_radius_m = 0.0;
  double cell_m = 0.0;
  double strong_A = 0.0;  ///< pulses of which a number is at least so much count, in the dataset's unit
  std::vector<MobilityCell> cells;  ///< squares whose centre lies in the dish, also those without a pulse

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("workspace_radius_m", workspace_radius_m);
    v.field("cell_m", cell_m);
    v.field("strong_A", strong_A);
    v.field("cells", cells);
  }
};

Mobility measure_mobility(const Dataset& dataset, double cell_m = 0.004);

}  // namespace lodestone::data
