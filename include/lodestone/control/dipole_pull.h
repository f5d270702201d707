#pragma once

#include <memory>

#include "lodestone/common/config.h"
#include "lodestone/control/controller.h"
#include "lodestone/control/driven_field.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::control {

/// Pull by the simulator of section IV-C: point-dipole coils and a point-dipole needle.
struct DipolePullConfig {
  // Searched by scripts/tune-baseline on the explored rig.
  double gain_N_m = 0.032;
  double max_force_N = 0.0006;
  double friction_share = 0.15;
  double rest_radius_m = 0.7e-3;
  double observer_share = 0.0;
  double mobility_m_per_N = 15.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("coil", "rig.coils");
    v.retired("needle_moment_A_m2", "rig.needle.moment_A_m2");
    v.retired("friction_N", "rig.friction.static_coefficient and rig.needle.net_weight_N");
    v.field("gain_N_m", gain_N_m, "N/m", "pull above friction per distance to the target", {0.0, 1e3});
    v.field("max_force_N", max_force_N, "N", "largest pull asked for", {0.0, 10.0});
    v.field("friction_share", friction_share, "",
            "of the pull that breaks the needle loose, what is added to every pull: one that turns into the "
            "field slides before it would be dragged",
            {0.0, 2.0});
    v.field("rest_radius_m", rest_radius_m, "m", "closer to the target there is no pull", {0.0, 0.1});
    v.field(
        "observer_share", observer_share, "",
        "disturbance observer: what a pulse says about the force that holds the needle back beyond what is "
        "known counts for so much; 0: none",
        {0.0, 1.0});
    v.field("mobility_m_per_N", mobility_m_per_N, "m/N",
            "its model: how far a pulse takes the needle per pull above friction", {1e-3, 1e6});
  }
};

/// Pull of dipole coils in terms of what drives them.
class DipolePull {
 public:
  explicit DipolePull(const physics::RigDescription& rig);

  /// Pull (N) of a drive (A) on a needle that has turned into the field: moment times the gradient of the
  /// field's magnitude.
  geometry::Vector2 pull_N(const geometry::Drive& drive_A, const geometry::Vector2& position_m) const;

  /// The drive (A) that pulls along `force_N`. The pull is proportional to the drive, so the search is over
  /// its direction only (physics::CoilDrive::along). Where none pulls exactly that way, the closest one.
  geometry::Drive drive_A(const geometry::Vector2& force_N, const geometry::Vector2& position_m) const;

 private:
  double moment_A_m2_;
  DrivenField field_;
};

/// Baseline: pulls the needle towards where the target will be after the pulse, with a force that grows with
/// the distance on top of what the floor takes, by the simulator's inverse field. Its disturbance observer
/// holds every motion against the one that the pull should have made, and adds what is missing to the next
/// pull (Ohishi et al. 1987: the inverse of a nominal model and a first-order filter; here along the pull, as
/// friction is).
class DipolePullController final : public Controller {
 public:
  /// Knows the rig as it is described; an action of 1 is its largest current.
  DipolePullController(const physics::RigDescription& rig, const DipolePullConfig& config)
      : config_(config),
        pull_(rig),
        friction_N_(config.friction_share * rig.breakaway_N()),
        scale_A_(rig.coils.max_current_A) {}
  void reset() override { disturbance_N_ = 0.0; }
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override { return std::make_unique<DipolePullController>(*this); }

 private:
  void observe(const task::Observation& observation);

  DipolePullConfig config_;
  DipolePull pull_;
  double friction_N_;  // what is added to every pull
  double scale_A_;
  double disturbance_N_ = 0.0;  // along the pull, against it
};

}  // namespace lodestone::control
