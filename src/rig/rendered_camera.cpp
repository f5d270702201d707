#include "lodestone/rig/rendered_camera.h"

#include "lodestone/common/error.h"

namespace lodestone::rig {

imaging::BenchGeometry bench_of(const physics::RigDescription& rig) {
  const physics::CoilGeometry& coil = rig.coils.geometry;
  imaging::BenchGeometry bench;
  bench.dish_radius_m = rig.dish.radius_m;
  bench.wall_height_m = rig.dish.wall_height_m;
  bench.wall_thickness_m = rig.dish.wall_thickness_m;
  constexpr double kPartOfSide = 0.66;  // that is drawn as a coil's bore is
  bench.coil_face_m = coil.centre_distance_m - 0.5 * coil.length_m;
  bench.coil_outer_radius_m = coil.outer_radius_m;
  bench.coil_bore_radius_m = coil.inner_radius_m;
  if (!rig.coils.each.empty()) {
    bench.coil_face_m = bench.coil_outer_radius_m = rig.dish.holder_m;
    bench.coil_bore_radius_m = kPartOfSide * rig.dish.holder_m;
    bench.coil_directions.clear();
    for (const physics::CoilDescription& one : rig.coils.each) {
      const geometry::Vector2 away_m = one.middle_m().head<2>();
      bench.coil_directions.push_back(away_m.norm() > 1e-3 ? geometry::Vector2(away_m.normalized())
                                                           : geometry::Vector2(0.0, 0.0));
    }
  }
  bench.coil_length_m = coil.length_m;
  bench.needle_length_m = rig.needle.length_m;
  bench.needle_diameter_m = rig.needle.diameter_m;
  bench.sphere = rig.needle.is_sphere();
  bench.tape_length_m = bench.sphere ? 0.0 : rig.needle.tape_length_m;
  bench.fluid_depth_m = rig.fluid.depth_m;
  bench.refractive_index = rig.fluid.refractive_index;
  return bench;
}

imaging::BenchGeometry rendered_bench_of(const VirtualRigConfig& rig) {
  imaging::BenchGeometry bench = bench_of(rig);
  for (const physics::ObstacleConfig& obstacle : rig.simulation.obstacles)
    bench.obstacles_m.push_back(obstacle.outline_m());
  return bench;
}

RenderedCamera::RenderedCamera(VirtualRig& rig, std::shared_ptr<const imaging::SceneRenderer> renderer,
                               common::RandomStream noise, common::Clock* clock)
    : rig_(rig),
      clock_(clock != nullptr ? *clock : rig.clock()),
      renderer_(std::move(renderer)),
      noise_(noise) {}

imaging::Frame RenderedCamera::grab(double timeout_s) {
  const double exposure_s = renderer_->scene().exposure_s;
  if (exposure_s > timeout_s)
    throw common::HardwareError("rendered camera: its exposure of " + std::to_string(exposure_s) +
                                " s is longer than the timeout of " + std::to_string(timeout_s) +
                                " s; shorten scene.exposure_s or raise the timeout");
  const double start_s = clock_.now_s();
  const geometry::Pose2 before = rig_.true_pose();
  clock_.sleep_until(start_s + exposure_s);
  const geometry::Pose2 after = rig_.true_pose();
  imaging::NeedleView needle;
  needle.smear_m = after.position_m() - before.position_m();
  const geometry::Vector2 middle_m = before.position_m() + 0.5 * needle.smear_m;
  needle.pose = {middle_m.x(), middle_m.y(),
                 before.heading_rad + 0.5 * geometry::wrap_angle(after.heading_rad - before.heading_rad)};
  const std::lock_guard<std::mutex> lock(mutex_);
  return {renderer_->render({needle}, noise_).image, start_s + 0.5 * exposure_s};
}

std::string RenderedCamera::save() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return noise_.save();
}

void RenderedCamera::restore(const std::string& state) {
  const std::lock_guard<std::mutex> lock(mutex_);
  noise_.restore(state);
}

}  // namespace lodestone::rig
