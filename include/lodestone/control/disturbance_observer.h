#pragma once

#include <memory>

#include "lodestone/control/observer_config.h"
#include "lodestone/control/pulse_model.h"

namespace lodestone::control {

/// A nominal model of pulses that is corrected by what they did: a discrete-time disturbance observer
/// (Ohishi et al. 1987; with sliding mode, and of a magnetic robot in a flow, arXiv 2604.01523). Every
/// pulse's residual goes through a first-order filter into two things:
///
/// - a gain, the factor on the currents at which the model would have moved the needle as far as it came;
/// - a disturbance, the vector that is left then: what carries the needle while it slides, flow for one.
///
/// Friction holds a needle at rest that is carried while it slides, so the drift of a rest is kept apart. It
/// is what stiction is told by: a pulse that did no more than a rest does has not moved the needle. Nothing
/// winds up then: its residual is no disturbance, the disturbance is forgotten towards the drift, and the
/// gain sinks to where the model breaks the needle loose, no further. All of it is bounded.
class DisturbanceObserver {
 public:
  /// The gain stays between this and one over it.
  static constexpr double kMostGain = 5.0;

  DisturbanceObserver(std::shared_ptr<const PulseModel> model, const ObserverConfig& config);

  /// Back to the description.
  void reset();
  /// One more pulse (A), or a rest, which is a drive of zeros: it took the needle from a pose by so much.
  void learn(const geometry::Pose2& before, const geometry::Drive& drive_A, const geometry::Vector2& moved_m);

  /// Where a pulse (A) takes the needle by model and gain alone,
  geometry::Pose2 modelled(const geometry::Pose2& pose, const geometry::Drive& drive_A) const {
    return model_->after(pose, drive_A, gain_);
  }
  /// and by all that is known: with the disturbance where the model moves the needle, with the drift where it
  /// does not, or rests.
  geometry::Pose2 after(const geometry::Pose2& pose, const geometry::Drive& drive_A) const;
  /// Whether a pulse that moved the needle by so much has not moved it.
  bool stuck(const geometry::Vector2& moved_m) const { return (moved_m - drift_m_).norm() < config_.still_m; }

  double gain() const { return gain_; }
  /// What is added to the model's motion, per pulse,
  const geometry::Vector2& disturbance_m() const { return disturbance_m_; }
  /// and what carries a needle that is not driven, per rest.
  const geometry::Vector2& drift_m() const { return drift_m_; }

 private:
  geometry::Vector2 modelled_m(const geometry::Pose2& before, const geometry::Drive& drive_A,
                               double gain) const;
  void learn_gain(const geometry::Pose2& before, const geometry::Drive& drive_A,
                  const geometry::Vector2& moved_m);
  /// Takes the observer's share of what was seen into an estimate.
  void filter(const geometry::Vector2& seen_m, geometry::Vector2& estimate_m) const;

  std::shared_ptr<const PulseModel> model_;
  ObserverConfig config_;
  double gain_ = 1.0;
  geometry::Vector2 disturbance_m_ = geometry::Vector2::Zero();
  geometry::Vector2 drift_m_ = geometry::Vector2::Zero();
};

}  // namespace lodestone::control
