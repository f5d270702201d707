#pragma once

namespace lodestone::control {

/// How a rig is identified while it is driven.
struct IdentificationConfig {
  bool enabled = true;
  bool carry = false;
  double prior_log_sigma = 0.45;
  double temper = 0.7;
  double noise_m = 0.5e-3;
  double noise_rad = 0.05;
  double outlier_share = 0.1;
  double place_sigma = 0.1;
  double drift_m = 1e-3;
  double drift_share = 0.2;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("enabled", enabled, "", "estimate from the pulses how strongly the rig answers to a drive");
    v.field("carry", carry, "", "on a bench, a trial begins with what the one before knew of it");
    v.field("prior_log_sigma", prior_log_sigma, "",
            "how much rigs differ: standard deviation of the logarithm of the gain", {1e-3, 2.0});
    v.field("temper", temper, "",
            "power of the likelihood: friction stays with the place, so pulses are not "
            "independent",
            {0.01, 1.0});
    v.field("noise_m", noise_m, "m", "what a motion may differ from the simulator by besides", {1e-6, 0.1});
    v.field("noise_rad", noise_rad, "rad", "and a turn", {1e-4, 1.0});
    v.field("outlier_share", outlier_share, "", "pulses that may do anything", {1e-6, 0.9});
    v.field("place_sigma", place_sigma, "",
            "how much friction makes the logarithm of the gain differ from one place to the next: what is "
            "known of "
            "it is unsure by so much more whenever the needle has moved",
            {0.0, 1.0});
    v.field(
        "drift_m", drift_m, "m",
        "how far a flow may carry the needle in a pulse that moves it: standard deviation of what is looked "
        "for; "
        "0: no flow is looked for",
        {0.0, 0.1});
    v.field("drift_share", drift_share, "", "how likely a flow is before any pulse was seen", {1e-6, 0.5});
  }
};

}  // namespace lodestone::control
