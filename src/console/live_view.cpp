#include "lodestone/console/live_view.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lodestone/common/artefact.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/rig/rendered_camera.h"

namespace lodestone::console {
namespace {

using common::Json;
using geometry::Vector2;

constexpr int kRing = 48;                // points of what is round
constexpr double kTwoSigma = 2.0;        // drawn of the covariance
constexpr int kArrows = 7;               // along a diameter of the dish
constexpr double kFullArrow_T = 0.02;    // a field that has the full length,
constexpr double kFullArrow_m = 0.006;   // which is this
constexpr double kPointer_m = 0.008;     // from a target along its heading
constexpr double kTick_m = 0.003;        // the same along a path
constexpr std::size_t kMostPlan = 2000;  // points that are shown, as each state has them

Vector2 unit(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }

double rounded(double value, double step) { return std::round(value / step) * step; }

/// Every so many of them that no more than `most` are left, and the last.
std::vector<Vector2> thinned(const std::vector<Vector2>& points_m, std::size_t most) {
  if (points_m.size() <= most) return points_m;
  std::vector<Vector2> few_m;
  for (std::size_t i = 0; i + 1 < points_m.size(); i += points_m.size() / (most - 1) + 1)
    few_m.push_back(points_m[i]);
  few_m.push_back(points_m.back());
  return few_m;
}

std::vector<Vector2> ring(const Vector2& centre_m, const Eigen::Matrix2d& half_axes) {
  std::vector<Vector2> points_m;
  for (int i = 0; i <= kRing; ++i)
    points_m.push_back(centre_m + half_axes * unit(2.0 * geometry::kPi * i / kRing));
  return points_m;
}

/// All around a side at a distance, from a half circle beyond its end to one before its beginning.
std::vector<Vector2> around(const Vector2& from_m, const Vector2& to_m, double distance_m) {
  const Vector2 along_m = to_m - from_m;
  const double angle_rad = std::atan2(along_m.y(), along_m.x());
  std::vector<Vector2> points_m;
  for (int i = 0; i <= kRing / 2; ++i)
    points_m.push_back(to_m + distance_m * unit(angle_rad + geometry::kPi * (2.0 * i / kRing - 0.5)));
  for (int i = 0; i <= kRing / 2; ++i)
    points_m.push_back(from_m + distance_m * unit(angle_rad + geometry::kPi * (2.0 * i / kRing + 0.5)));
  return points_m;
}

Json limit(const char* name, double value, double bound, const char* unit_of_both) {
  return {{"name", name}, {"value", value}, {"bound", bound}, {"unit", unit_of_both}};
}

double largest(const physics::PerCoil& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

}  // namespace

ImagePlace ImageMap::to_image(const Vector2& point_m) const {
  const Eigen::Vector2d pixel = camera_.project_floor(point_m);
  return {(pixel.x() + 0.5) / static_cast<double>(camera_.width_px),
          (pixel.y() + 0.5) / static_cast<double>(camera_.height_px)};
}

Vector2 ImageMap::to_dish(const ImagePlace& place) const {
  return camera_.to_dish({place.x() * static_cast<double>(camera_.width_px) - 0.5,
                          place.y() * static_cast<double>(camera_.height_px) - 0.5});
}

Json ImageMap::json(const Vector2& point_m) const {
  const ImagePlace place = to_image(point_m);
  return {rounded(place.x(), 1e-5), rounded(place.y(), 1e-5)};
}

Json ImageMap::json(const std::vector<Vector2>& points_m) const {
  Json points = Json::array();
  for (const Vector2& point_m : points_m) points.push_back(json(point_m));
  return points;
}

Json LiveView::json(const BenchSample& sample) {
  Json json = common::artefact_to_json(sample);
  for (const char* may_lack : {"error_mm", "temperature_C", "supply_V", "pose_age_ms", "jitter_ms"})
    if (!json.contains(may_lack)) json[may_lack] = nullptr;
  return json;
}

Json LiveView::pose(const BenchState& state, const std::optional<ImageMap>& map) const {
  if (!state.pose) return nullptr;
  const control::PoseEstimate& seen = *state.pose;
  Json pose = {{"valid", seen.valid}, {"why", seen.reason}, {"age_s", state.now_s - seen.stamp_s}};
  if (!seen.valid) return pose;
  const Vector2 middle_m = seen.pose.position_m();
  pose["x_mm"] = geometry::kMmPerM * middle_m.x();
  pose["y_mm"] = geometry::kMmPerM * middle_m.y();
  const bool sphere = rig_.needle.is_sphere();
  if (!sphere) pose["heading_deg"] = geometry::kDegPerRad * seen.pose.heading_rad;
  pose["sigma_mm"] = geometry::kMmPerM * seen.position_sigma_m;
  if (!map) return pose;
  const Vector2 half_m = 0.5 * rig_.needle.length_m * unit(seen.pose.heading_rad);
  pose["middle"] = map->json(middle_m);
  if (sphere) return pose;
  pose["head"] = map->json(Vector2(middle_m + half_m));
  pose["tail"] = map->json(Vector2(middle_m - half_m));
  return pose;
}

Json LiveView::field(const BenchState& state, const ImageMap& map) const {
  Json arrows = Json::array();
  if (largest(state.on_A) == 0.0) return arrows;
  const double step_m = 2.0 * rig_.dish.radius_m / (kArrows - 1);
  for (int row = 0; row < kArrows; ++row) {
    for (int column = 0; column < kArrows; ++column) {
      const Vector2 at_m(-rig_.dish.radius_m + column * step_m, -rig_.dish.radius_m + row * step_m);
      if (at_m.norm() > rig_.dish.radius_m) continue;
      const Vector2 field_T = field_.at(state.on_A, at_m).field_T;
      const double strength = std::min(1.0, std::sqrt(field_T.norm() / kFullArrow_T));
      const ImagePlace from = map.to_image(at_m);
      const ImagePlace along = map.to_image(at_m + kFullArrow_m * strength * field_T.normalized()) - from;
      arrows.push_back({from.x(), from.y(), along.x(), along.y()});
    }
  }
  return arrows;
}

void LiveView::draw(const BenchState& state, const ImageMap& map, Json& view) const {
  if (state.pose && state.pose->valid) {
    const Eigen::LLT<Eigen::Matrix2d> root(state.pose->position_covariance_m2);
    if (root.info() == Eigen::Success)
      view["spread"] = map.json(
          ring(state.pose->pose.position_m(), Eigen::Matrix2d(kTwoSigma * Eigen::Matrix2d(root.matrixL()))));
  }
  view["trail"] = map.json(state.trail_m);
  if (state.target_m) view["target"] = map.json(*state.target_m);
  if (state.target_m && state.target_heading_rad)
    view["target_head"] = map.json(Vector2(*state.target_m + kPointer_m * unit(*state.target_heading_rad)));
  if (!state.plan_m.empty()) view["plan"] = map.json(thinned(state.plan_m, kMostPlan));
  for (const geometry::Pose2& lies : state.plan_headings)
    view["plan_heads"].push_back(map.json(
        std::vector<Vector2>{lies.position_m(), lies.position_m() + kTick_m * unit(lies.heading_rad)}));
  view["fence"] =
      map.json(ring(Vector2::Zero(), safety_.geofence * rig_.dish.radius_m * Eigen::Matrix2d::Identity()));
  for (const geometry::Zone& zone : state.keep_out.zones) {
    const std::vector<Vector2> corners_m = zone.points_m();
    for (std::size_t i = 0; i < corners_m.size(); ++i)
      view["keep_out"].push_back(
          map.json(around(corners_m[i], corners_m[(i + 1) % corners_m.size()], zone.radius_m)));
  }
  view["field"] = field(state, map);
  std::vector<Vector2> coils_m;
  const imaging::BenchGeometry bench = rig::bench_of(rig_);
  for (const Vector2& direction : bench.coil_directions) coils_m.push_back(bench.coil_face_m * direction);
  view["coil_places"] = map.json(coils_m);
  const ImagePlace centre = map.to_image(Vector2::Zero());
  for (const Vector2& axis : {Vector2(kPointer_m, 0.0), Vector2(0.0, kPointer_m)}) {
    const ImagePlace along = map.to_image(axis) - centre;
    view["axes"].push_back({along.x(), along.y()});
  }
}

Json LiveView::limits(const BenchState& state) const {
  Json limits = Json::array();
  if (!state.sample) return limits;
  const BenchSample& sample = *state.sample;
  limits.push_back(limit("current", largest(sample.current_A),
                         std::min(safety_.max_current_A, rig_.coils.max_current_A), "A"));
  limits.push_back(limit("time switched on", 100.0 * largest(sample.duty), 100.0 * safety_.max_duty, "%"));
  if (sample.temperature_C)
    limits.push_back(
        limit("coil temperature", largest(*sample.temperature_C), safety_.max_temperature_C, "C"));
  if (state.pose && state.pose->valid)
    limits.push_back(limit("distance from the centre",
                           geometry::kMmPerM * state.pose->pose.position_m().norm(),
                           geometry::kMmPerM * safety_.geofence * rig_.dish.radius_m, "mm"));
  if (sample.pose_age_ms)
    limits.push_back(limit("age of the pose", *sample.pose_age_ms, 1e3 * safety_.max_pose_age_s, "ms"));
  if (sample.jitter_ms) limits.push_back(limit("jitter", *sample.jitter_ms, 1e3 * safety_.max_late_s, "ms"));
  return limits;
}

Json LiveView::json(const BenchState& state) const {
  const std::optional<ImageMap> map = state.camera ? std::optional<ImageMap>(*state.camera) : std::nullopt;
  Json view = {{"kind", "state"},
               {"time_s", state.now_s},
               {"mode", common::name_of(state.mode)},
               {"reason", state.reason},
               {"clears", state.clears},
               {"why_not", state.why_not},
               {"controller", state.controller},
               {"unattended", state.unattended},
               {"attended", state.attended},
               {"on_A", state.on_A},
               {"run", nullptr},
               {"pose", pose(state, map)},
               {"sample", nullptr},
               {"limits", limits(state)}};
  if (state.run) {
    const BenchRun& run = *state.run;
    view["run"] = {{"task", run.task}, {"time_s", run.time_s}, {"left_s", nullptr}, {"steps", run.steps}};
    if (run.left_s) view["run"]["left_s"] = *run.left_s;
  }
  if (state.sample) view["sample"] = json(*state.sample);
  if (map) draw(state, *map, view);
  return view;
}

}  // namespace lodestone::console
