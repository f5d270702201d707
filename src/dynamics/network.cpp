#include "lodestone/dynamics/network.h"

#include <ATen/TensorOperators.h>
#include <ATen/core/grad_mode.h>
#include <ATen/ops/atan2.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/ones.h>
#include <ATen/ops/ones_like.h>
#include <ATen/ops/stack.h>
#include <ATen/ops/where.h>
#include <ATen/ops/zeros.h>

#include "lodestone/common/error.h"
#include "lodestone/dynamics/mixture.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::dynamics {
namespace {

constexpr int kHeading = 2;               ///< column of the heading in a pose state
constexpr double kSmallestSpread = 1e-9;  ///< a column that never varies keeps its unit

void fit(at::Tensor& mean, at::Tensor& spread, const at::Tensor& rows) {
  const at::Tensor wide = rows.to(at::kDouble);
  const at::Tensor std = wide.std(0, /*unbiased=*/false);
  mean.copy_(wide.mean(0));
  spread.copy_(at::where(std < kSmallestSpread, at::ones_like(std), std));
}

/// How rows of states are seen in the same eighth of the dish: geometry::SquareView, row by row.
class EighthViews {
 public:
  explicit EighthViews(const at::Tensor& state) {
    const at::Tensor x = state.narrow(1, 0, 1), y = state.narrow(1, 1, 1);
    const at::Tensor right = (x >= 0) & (y <= x) & (y >= -x);
    const at::Tensor up = ~right & (y > 0) & (y >= x) & (y >= -x);
    const at::Tensor left = ~right & ~up & (x < 0) & (y <= -x) & (y >= x);
    const at::Tensor down = ~right & ~up & ~left;
    cosine_ = right.to(state.dtype()) - left.to(state.dtype());
    sine_ = up.to(state.dtype()) - down.to(state.dtype());
    quarter_turns_rad_ = 0.5 * geometry::kPi *
                         (up.to(state.dtype()) + 2.0 * left.to(state.dtype()) + 3.0 * down.to(state.dtype()));
    const at::Tensor beside = cosine_ * y - sine_ * x;
    mirror_ = at::where(beside < 0, -at::ones_like(beside), at::ones_like(beside));
  }

  /// Vectors [N, 2], or poses [N, 3], as they are seen, and back.
  at::Tensor enter(const at::Tensor& rows) const {
    const at::Tensor x = rows.narrow(1, 0, 1), y = rows.narrow(1, 1, 1);
    const at::Tensor along = cosine_ * x + sine_ * y;
    const at::Tensor beside = mirror_ * (cosine_ * y - sine_ * x);
    if (rows.size(1) == 2) return at::cat({along, beside}, 1);
    return at::cat({along, beside, wrap_angles(mirror_ * (rows.narrow(1, kHeading, 1) - quarter_turns_rad_))},
                   1);
  }
  at::Tensor leave(const at::Tensor& rows) const {
    const at::Tensor along = rows.narrow(1, 0, 1), beside = mirror_ * rows.narrow(1, 1, 1);
    const at::Tensor x = cosine_ * along - sine_ * beside;
    const at::Tensor y = sine_ * along + cosine_ * beside;
    if (rows.size(1) == 2) return at::cat({x, y}, 1);
    return at::cat({x, y, wrap_angles(mirror_ * rows.narrow(1, kHeading, 1) + quarter_turns_rad_)}, 1);
  }
  /// Which view a row is seen in: geometry::SquareView::write_view, row by row.
  at::Tensor numbers() const { return at::cat({cosine_, sine_, mirror_}, 1); }

 private:
  at::Tensor cosine_, sine_, quarter_turns_rad_, mirror_;  // [N, 1]
};

}  // namespace

at::Tensor wrap_angles(const at::Tensor& angle_rad) {
  return angle_rad - 2.0 * geometry::kPi * ((angle_rad - geometry::kPi) / (2.0 * geometry::kPi)).ceil();
}

Network::Network(const DynamicsConfig& config, const data::RowLayout& rows)
    : config_(config), layout_(rows.state), action_size_(rows.action_size) {
  std::int64_t width = config.inputs(rows);
  const std::int64_t outputs = data::state_size(layout_);
  input_mean = tensors_.add_buffer("input_mean", at::zeros({width}));
  input_std = tensors_.add_buffer("input_std", at::ones({width}));
  output_mean = tensors_.add_buffer("output_mean", at::zeros({outputs}));
  output_std = tensors_.add_buffer("output_std", at::ones({outputs}));
  int place = 0;
  const auto name = [&place] { return "layers." + std::to_string(place++); };
  if (config.batch_norm) norm_.emplace_back(tensors_, name(), width);
  for (const std::int64_t hidden : config.hidden) {
    linear_.emplace_back(tensors_, name(), width, hidden);
    if (config.batch_norm) norm_.emplace_back(tensors_, name(), hidden);
    ++place;  // ReLU has a place among the names, too
    width = hidden;
  }
  linear_.emplace_back(tensors_, name(), width, config.components > 0 ? mixture().outputs() : outputs);
}

void Network::initialise(common::RandomStream& random) {
  for (nets::Linear& linear : linear_) linear.initialise(random);
  const at::NoGradGuard no_grad;
  view_columns(linear_.front().weight).zero_();
}

at::Tensor Network::layers(const at::Tensor& input) const {
  at::Tensor x = norm_.empty() ? input : norm_.front()(input, training_);
  if (config_.input_relu) x = x.relu();
  for (std::size_t i = 0; i + 1 < linear_.size(); ++i) {
    x = linear_[i](x);
    if (!norm_.empty()) x = norm_[i + 1](x, training_);
    x = x.relu();
  }
  return linear_.back()(x);
}

at::Tensor Network::features(const at::Tensor& state, const at::Tensor& action) const {
  if (!config_.sees_an_eighth()) return seen_features(state, action, {});
  const EighthViews views(state);
  return seen_features(views.enter(state), views.enter(action),
                       config_.tells_view() ? views.numbers() : at::Tensor());
}

at::Tensor Network::seen_features(const at::Tensor& state, const at::Tensor& action,
                                  const at::Tensor& views) const {
  std::vector<at::Tensor> columns = {state};
  at::Tensor sine, cosine;
  if (config_.sine_cosine(layout_)) {
    const at::Tensor heading = state.narrow(1, kHeading, 1);
    sine = heading.sin();
    cosine = heading.cos();
    columns = {state.narrow(1, 0, kHeading), sine, cosine};
  }
  if (views.defined()) columns.push_back(views);
  if (config_.sees_drive_by_needle(rows())) {
    const at::Tensor x = action.narrow(1, 0, 1), y = action.narrow(1, 1, 1);
    columns.push_back(x * cosine + y * sine);
    columns.push_back(y * cosine - x * sine);
  }
  columns.push_back(action);
  return at::cat(columns, 1);
}

at::Tensor Network::normalised_input(const at::Tensor& state, const at::Tensor& action) const {
  return ((features(state, action) - input_mean) / input_std).to(at::kFloat);
}

at::Tensor Network::normalised_output(const at::Tensor& state, const at::Tensor& action) const {
  const at::Tensor raw = layers(normalised_input(state, action));
  return config_.components > 0 ? mixture_mean(raw, mixture()) : raw;
}

at::Tensor Network::target(const at::Tensor& state, const at::Tensor& next_state) const {
  at::Tensor from = state, to = next_state;
  if (config_.sees_an_eighth()) {
    const EighthViews views(state);
    from = views.enter(from);
    to = views.enter(to);
  }
  if (!config_.predicts_change()) return to;
  to = to - from;
  if (layout_ == data::StateLayout::kPosition) return to;
  return at::cat({to.narrow(1, 0, kHeading), wrap_angles(to.narrow(1, kHeading, 1))}, 1);
}

at::Tensor Network::normalised_target(const at::Tensor& state, const at::Tensor& next_state) const {
  return ((target(state, next_state) - output_mean) / output_std).to(at::kFloat);
}

at::Tensor Network::forward(const at::Tensor& state, const at::Tensor& action) const {
  at::Tensor next = normalised_output(state, action) * output_std + output_mean;
  if (config_.sees_an_eighth()) {
    const EighthViews views(state);
    return views.leave(config_.predicts_change() ? views.enter(state) + next : next);
  }
  if (config_.predicts_change()) next = state + next;
  if (layout_ == data::StateLayout::kPosition) return next;
  return at::cat({next.narrow(1, 0, kHeading), wrap_angles(next.narrow(1, kHeading, 1))}, 1);
}

void Network::fit_normalisers(const at::Tensor& state, const at::Tensor& action,
                              const at::Tensor& next_state) {
  fit(input_mean, input_std, features(state, action));
  view_columns(input_mean).zero_();  // numbers from -1 to 1 already, some of which may never vary
  view_columns(input_std).fill_(1.0);
  output_mean.zero_();
  output_std.fill_(1.0);
  fit(output_mean, output_std, target(state.to(at::kDouble), next_state.to(at::kDouble)));
}

at::Tensor Network::view_columns(const at::Tensor& by_input) const {
  return by_input.narrow(-1, config_.state_inputs(layout_), config_.view_inputs());
}

void Network::scale_drive(double gain) {
  const at::NoGradGuard no_grad;
  for (at::Tensor* numbers : {&input_mean, &input_std})
    numbers->narrow(-1, numbers->size(-1) - config_.drive_inputs(rows()), config_.drive_inputs(rows()))
        .div_(gain);
}

Members make_members(const DynamicsConfig& config, const data::RowLayout& rows, std::uint64_t seed) {
  Members members;
  for (std::int64_t k = 0; k < config.members; ++k) {
    members.push_back(std::make_shared<Network>(config, rows));
    common::RandomStream random(seed, "dynamics", static_cast<std::uint64_t>(k));
    members.back()->initialise(random);
  }
  return members;
}

at::Tensor predict_mean(const Members& members, const at::Tensor& state, const at::Tensor& action) {
  LODESTONE_CHECK(!members.empty(), "the ensemble has no member");
  const at::NoGradGuard no_grad;
  std::vector<at::Tensor> next;
  for (const auto& member : members) {
    member->train(false);
    next.push_back(member->forward(state, action));
  }
  const at::Tensor all = at::stack(next);
  at::Tensor mean = all.mean(0);
  if (members.front()->layout() == data::StateLayout::kPose) {
    const at::Tensor headings = all.select(2, kHeading);
    mean.select(1, kHeading).copy_(at::atan2(headings.sin().mean(0), headings.cos().mean(0)));
  }
  return mean;
}

inference::FoldedDynamics fold(const Network& network) {
  return {nets::to_arrays(network.tensors().named()), network.config(), network.rows(), "dynamics network"};
}

}  // namespace lodestone::dynamics
