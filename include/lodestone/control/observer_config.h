#pragma once

namespace lodestone::control {

/// How the controller with a disturbance observer learns from its pulses, and how it comes to its target.
struct ObserverConfig {
  double disturbance_share = 0.0;
  double most_disturbance_m = 0.004;
  double gain_share = 0.0;
  double first_gain = 1.2;
  double still_m = 0.3e-3;
  double still_deg = 3.0;
  double reaching_share = 0.4;
  double switching_m = 0.2e-3;
  double boundary_m = 0.7e-3;
  double longest_m = 0.012;
  double stuck_growth = 1.2;
  double heading_cost_mm = 5.0;
  double heading_within_m = 0.003;
  double heading_deg = 8.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("disturbance_share", disturbance_share, "",
            "of what a pulse moved the needle beyond the model, so much is taken for a disturbance that "
            "stays; 0: no observer",
            {0.0, 1.0});
    v.field("most_disturbance_m", most_disturbance_m, "m", "no disturbance of a pulse is longer than this",
            {0.0, 0.1});
    v.field("gain_share", gain_share, "",
            "so much of the logarithm of the gain that would explain a pulse is believed; 0: the first one "
            "stays",
            {0.0, 1.0});
    v.field("first_gain", first_gain, "",
            "factor on the described currents that is believed before the first pulse; 1: the description",
            {0.25, 4.0});
    v.field("still_m", still_m, "m",
            "a pulse that did less than this beyond what a rest does has not moved the needle", {0.0, 0.1});
    v.field("still_deg", still_deg, "deg", "nor has a smaller turn than this turned it", {0.0, 180.0});
    v.field("reaching_share", reaching_share, "",
            "reaching law: a pulse shall take away so much of the distance to the target", {0.0, 1.0});
    v.field("switching_m", switching_m, "m", "and so much more, the switching term", {0.0, 0.1});
    v.field("boundary_m", boundary_m, "m",
            "boundary layer: no pulse where the needle will lie within this of its target anyway",
            {0.0, 0.1});
    v.field("longest_m", longest_m, "m", "no pulse is meant to take the needle further", {1e-4, 1.0});
    v.field("stuck_growth", stuck_growth, "", "factor on the drive per pulse that did not move the needle",
            {1.0, 4.0});
    v.field("heading_cost_mm", heading_cost_mm, "mm/rad",
            "cost of a heading error, where the target has a heading", {0.0, 1000.0});
    v.field("heading_within_m", heading_within_m, "m",
            "headings count along a path, and within this of a target that stays", {0.0, 0.1});
    v.field("heading_deg", heading_deg, "deg", "and where they do, there is no rest beyond this of them",
            {0.0, 180.0});
  }
};

}  // namespace lodestone::control
