#include "lodestone/inference/cost_to_go.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lodestone::inference {
namespace {

constexpr double kFine_m = 5e-4;   // distances are told apart down to this,
constexpr double kFine_deg = 2.0;  // and turns to this

/// 0 at 0, 1 at `most`, and as fine below `fine` as above it.
double logarithmic(double value, double fine, double most) {
  return std::log1p(value / fine) / std::log1p(most / fine);
}

std::vector<LinearLayer> layers_of(const Arrays& weights, const std::vector<std::int64_t>& hidden,
                                   const std::string& what) {
  std::vector<std::int64_t> widths = hidden;
  widths.push_back(1);
  std::vector<LinearLayer> layers;
  std::int64_t inputs = CostToGo::kFeatures;
  for (const std::int64_t width : widths) {
    const std::string name = "l" + std::to_string(layers.size() + 1);
    layers.push_back({weight_at(weights, name + ".weight", {width, inputs}, what).to_vector<float>(),
                      weight_at(weights, name + ".bias", {width}, what).to_vector<float>()});
    inputs = width;
  }
  return layers;
}

}  // namespace

PoseCost::Off PoseCost::off(const geometry::Pose2& pose, const geometry::Pose2& goal) const {
  return {(pose.position_m() - goal.position_m()).norm() / tolerance_m,
          std::abs(geometry::kDegPerRad * geometry::wrap_angle(pose.heading_rad - goal.heading_rad)) /
              tolerance_deg};
}

double PoseCost::at(const geometry::Pose2& pose, const geometry::Pose2& goal) const {
  const auto [away, turned] = off(pose, goal);
  const double square = away * away + turned * turned;
  return -std::expm1(-square * square);
}

bool PoseCost::within(double share, const geometry::Pose2& pose, const geometry::Pose2& goal) const {
  const auto [away, turned] = off(pose, goal);
  return away < share && turned < share;
}

double PoseCost::of_staying(const geometry::Pose2& pose, const geometry::Pose2& goal) const {
  return most() * (pose.position_m().norm() > dish_radius_m ? 1.0 : at(pose, goal));
}

CostToGo::CostToGo(Arrays weights, std::vector<std::int64_t> hidden, const PoseCost& cost,
                   const std::string& what)
    : weights_(std::move(weights)),
      hidden_(std::move(hidden)),
      cost_(cost),
      network_(layers_of(weights_, hidden_, what)) {}

void CostToGo::write_features(const geometry::Pose2& pose, const geometry::Pose2& goal, double dish_radius_m,
                              float* out) {
  const geometry::Vector2 way_m = goal.position_m() - pose.position_m();
  const double distance_m = way_m.norm();
  const double c = std::cos(pose.heading_rad);
  const double s = std::sin(pose.heading_rad);
  const double softened_m = std::hypot(distance_m, kFine_m);
  const double turn_rad = geometry::wrap_angle(goal.heading_rad - pose.heading_rad);
  const double turn_deg = geometry::kDegPerRad * std::abs(turn_rad);
  const double along = (c * way_m.x() + s * way_m.y()) / softened_m;
  const double across = (c * way_m.y() - s * way_m.x()) / softened_m;
  const double turned = std::copysign(logarithmic(turn_deg, kFine_deg, 180.0), turn_rad);
  const double numbers[kFeatures] = {
      along, across, logarithmic(distance_m, kFine_m, dish_radius_m), std::cos(turn_rad), std::sin(turn_rad),
      turned, pose.x_m / dish_radius_m, pose.y_m / dish_radius_m, c, s,
      pose.position_m().norm() / dish_radius_m, goal.x_m / dish_radius_m, goal.y_m / dish_radius_m,
      // The way from the goal's side: whether it lies ahead of a needle that already lies as it shall.
      (std::cos(goal.heading_rad) * way_m.x() + std::sin(goal.heading_rad) * way_m.y()) / softened_m,
      (std::cos(goal.heading_rad) * way_m.y() - std::sin(goal.heading_rad) * way_m.x()) / softened_m};
  std::transform(numbers, numbers + kFeatures, out, [](double x) { return static_cast<float>(x); });
}

void CostToGo::evaluate(const double* state, const geometry::Pose2* goal, std::int64_t rows_per_goal,
                        std::int64_t rows, double* cost, Workspace& workspace) const {
  float* input = network_.input(rows, workspace);
  for (std::int64_t row = 0; row < rows; ++row) {
    const geometry::Pose2 pose{state[3 * row], state[3 * row + 1], state[3 * row + 2]};
    write_features(pose, goal[row / rows_per_goal], cost_.dish_radius_m, input + row * kFeatures);
  }
  const float* share = network_.forward(rows, workspace);
  for (std::int64_t row = 0; row < rows; ++row) {
    const geometry::Pose2 pose{state[3 * row], state[3 * row + 1], state[3 * row + 2]};
    const double staying = cost_.of_staying(pose, goal[row / rows_per_goal]);
    const double going = cost_.most() * std::max(0.0, static_cast<double>(share[row]));
    const bool outside = pose.position_m().norm() > cost_.dish_radius_m;
    cost[row] =
        outside ? cost_.most() : (1.0 - cost_.discount) * staying + cost_.discount * std::min(staying, going);
  }
}

}  // namespace lodestone::inference
