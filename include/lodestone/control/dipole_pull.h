#pragma once

#include "lodestone/common/config.h"
#include "lodestone/control/controller.h"
#include "lodestone/control/dipole_field.h"

namespace lodestone::control {

/// Pull by the simulator of section IV-C: point-dipole coils and a point-dipole needle.
struct DipolePullConfig {
  physics::CoilGeometry coil;
  double needle_moment_A_m2 = 0.00169;
  double friction_N = 0.000158;
  double gain_N_m = 0.012;
  double max_force_N = 0.0006;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("coil", coil, "coils, used as point dipoles");
    v.field("needle_moment_A_m2", needle_moment_A_m2, "A m^2", "magnetic moment of the needle", {1e-9, 1.0});
    v.field("friction_N", friction_N, "N",
            "pull that just moves the needle: static friction times its weight", {0.0, 1.0});
    v.field("gain_N_m", gain_N_m, "N/m", "pull above friction per distance to the target", {0.0, 1e3});
    v.field("max_force_N", max_force_N, "N", "largest pull asked for", {0.0, 10.0});
  }
};

/// Field of four dipole coils seen as two signed axis drives.
class DipolePull {
 public:
  explicit DipolePull(const DipolePullConfig& config);

  /// Pull (N) of axis drives (A) on a needle that has turned into the field: moment times the gradient of the
  /// field's magnitude.
  geometry::Vector2 pull_N(const geometry::Vector2& axis_drive_A, const geometry::Vector2& position_m) const;

  /// Axis drives (A) that pull along `force_N`. The pull is proportional to the drives, so the search is over
  /// their ratio only. Where no ratio pulls exactly that way, the closest one.
  geometry::Vector2 drive_A(const geometry::Vector2& force_N, const geometry::Vector2& position_m) const;

 private:
  double moment_A_m2_;
  DipoleField field_;
};

/// Baseline: pulls the needle towards the target with a force that grows with the distance, by the
/// simulator's inverse field.
class DipolePullController final : public Controller {
 public:
  /// `scale_A`: current that an action of 1 maps to.
  DipolePullController(const DipolePullConfig& config, double scale_A)
      : config_(config), pull_(config), scale_A_(scale_A) {}
  void reset() override {}
  geometry::Vector2 act(const task::Observation& observation) override;

 private:
  DipolePullConfig config_;
  DipolePull pull_;
  double scale_A_;
};

}  // namespace lodestone::control
