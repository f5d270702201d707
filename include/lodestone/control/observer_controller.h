#pragma once

#include <memory>
#include <optional>

#include "lodestone/control/controller.h"
#include "lodestone/control/disturbance_observer.h"
#include "lodestone/control/observer_config.h"
#include "lodestone/control/pulse_model.h"

namespace lodestone::control {

/// Classical control by the description and the pulses' own residuals: discrete-time sliding mode with a
/// disturbance observer (the combination: arXiv 2604.01523, for a magnetic robot in a flow).
///
/// - Sliding variable: where the target is, less where the needle is. Reaching law (Gao, Wang and Homaifa,
///   IEEE Trans. Ind. Electron. 42, 1995): a pulse shall take away a share of it and a constant more, and
///   lead to where a moving target will be meanwhile (feedforward). Within a boundary layer there is no
///   pulse.
/// - Inverse: the drive whose outcome, by model, gain and disturbance, is nearest to that. Searched without
///   chance: directions of field and pull around the wanted one, the strength of each by bisection, the best
///   direction then halved down to. Where a heading is wanted, the outcome's counts, and so do pulses that
///   turn the needle before they move it.
/// - Switching: the drive grows while the needle is stuck, and is the model's again once it has moved.
class ObserverController final : public Controller {
 public:
  /// Knows the rig as it is described, in a loop whose pulses and rests are so long; an action of 1 is its
  /// largest current. What identifies the rig for others (Observation::drive_gain) is left aside.
  ObserverController(const physics::RigDescription& rig, const ObserverConfig& config, double pulse_s,
                     double rest_s);
  void reset() override;
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override { return std::make_unique<ObserverController>(*this); }

  const DisturbanceObserver& observer() const { return observer_; }

 private:
  /// What a pulse is meant to do.
  struct Aim {
    geometry::Vector2 point_m;
    geometry::Vector2 motion_m;  ///< that the model has to make of it; not zero
    std::optional<double> heading_rad;
  };
  struct Candidate {
    geometry::Drive action;
    double cost_mm;
  };

  void observe(const task::Observation& observation);
  geometry::Drive decide(const task::Observation& observation) const;
  Aim aim(const task::Observation& observation, std::optional<double> heading_rad) const;
  Candidate best_along(double direction_rad, const Aim& aim, const geometry::Pose2& pose) const;
  geometry::Drive inverse(const Aim& aim, const geometry::Pose2& pose) const;

  ObserverConfig config_;
  std::shared_ptr<const PulseModel> model_;
  DisturbanceObserver observer_;
  double scale_A_;
  double growth_ = 1.0;                  // of the drive, while the needle is stuck
  std::optional<geometry::Pose2> seen_;  // when it was last asked,
  bool drove_ = false;                   // and what it did then
};

}  // namespace lodestone::control
