#include "lodestone/inference/folded_dynamics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/inference/batch_norm.h"

namespace lodestone::inference {
namespace {

using Numbers = std::vector<double>;

struct WideLayer {
  Numbers weight;  // [outputs, inputs]
  Numbers bias;
};

/// Gathers linear maps and normalisations into as few linear layers as possible.
class Folder {
 public:
  /// Starts with x -> (x - mean) / spread.
  Folder(const Numbers& mean, const Numbers& spread) : scale_(mean.size()), shift_(mean.size()) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      scale_[i] = 1.0 / spread[i];
      shift_[i] = -mean[i] * scale_[i];
    }
  }

  void add_linear(Numbers weight, Numbers bias) {
    const std::size_t inputs = scale_.size();
    for (std::size_t row = 0; row < bias.size(); ++row) {
      double* weights = &weight[row * inputs];
      double sum = 0.0;
      for (std::size_t i = 0; i < inputs; ++i) {
        sum += weights[i] * shift_[i];
        weights[i] *= scale_[i];
      }
      bias[row] += sum;
    }
    layers_.push_back({std::move(weight), std::move(bias)});
    after_linear_ = true;
  }

  void add_relu() {
    if (!after_linear_) add_identity();
    scale_.assign(layers_.back().bias.size(), 1.0);
    shift_.assign(layers_.back().bias.size(), 0.0);
    after_linear_ = false;
  }

  /// y = scale * x + shift: into the linear layer before it, or kept for the one that follows.
  void affine(const Numbers& scale, const Numbers& shift) {
    Numbers& bias = after_linear_ ? layers_.back().bias : shift_;
    for (std::size_t i = 0; i < scale.size(); ++i) {
      bias[i] = bias[i] * scale[i] + shift[i];
      if (!after_linear_) {
        scale_[i] *= scale[i];
        continue;
      }
      const std::size_t inputs = layers_.back().weight.size() / scale.size();
      for (std::size_t j = 0; j < inputs; ++j) layers_.back().weight[i * inputs + j] *= scale[i];
    }
  }

  /// What was kept so far becomes a layer of its own.
  void add_identity() {
    const std::size_t width = scale_.size();
    Numbers weight(width * width, 0.0);
    for (std::size_t i = 0; i < width; ++i) weight[i * width + i] = 1.0;
    add_linear(std::move(weight), Numbers(width, 0.0));
  }

  std::vector<LinearLayer> layers() const {
    std::vector<LinearLayer> narrow;
    for (const WideLayer& layer : layers_)
      narrow.push_back({{layer.weight.begin(), layer.weight.end()}, {layer.bias.begin(), layer.bias.end()}});
    return narrow;
  }

 private:
  std::vector<WideLayer> layers_;
  Numbers scale_, shift_;
  bool after_linear_ = false;
};

/// Spreads that are divided by.
void check_above_zero(const Numbers& spread, const std::string& name, const std::string& what) {
  if (std::any_of(spread.begin(), spread.end(), [](double value) { return !(value > 0.0); }))
    throw common::CheckpointError(what + ": array \"" + name + "\" holds a spread that is not above 0");
}

/// Whether rows are turned into an eighth of the dish, for which drives have to be vectors.
bool can_be_turned(const DynamicsConfig& config, const data::RowLayout& rows, const std::string& what) {
  if (config.sees_an_eighth() && rows.action_size != 2)
    throw common::CheckpointError(what +
                                  ": symmetry square needs drives of two numbers, along x and y, not of " +
                                  std::to_string(rows.action_size));
  return config.sees_an_eighth();
}

/// The linear layers of a dynamics network with every normalisation worked into them, in float64 until the
/// end. Throws CheckpointError that begins with `what` when `weights` are not those of the shape.
std::vector<LinearLayer> fold(const Arrays& weights, const DynamicsConfig& config,
                              const data::RowLayout& rows, const std::string& what) {
  const auto numbers = [&](const std::string& name, const std::vector<std::int64_t>& shape) {
    return weight_at(weights, name, shape, what).to_double();
  };
  std::int64_t place = 0;  // in dynamics::Network's sequence of layers
  std::int64_t width = config.inputs(rows);
  const Numbers input_std = numbers("input_std", {width});
  check_above_zero(input_std, "input_std", what);
  Folder folder(numbers("input_mean", {width}), input_std);
  const auto add_batch_norm = [&] {
    if (!config.batch_norm) return;
    const std::string prefix = "layers." + std::to_string(place++) + ".";
    Numbers scale = numbers(prefix + "weight", {width});
    Numbers shift = numbers(prefix + "bias", {width});
    const Numbers mean = numbers(prefix + "running_mean", {width});
    Numbers variance = numbers(prefix + "running_var", {width});
    for (double& value : variance) value += kBatchNormEpsilon;
    check_above_zero(variance, prefix + "running_var", what);
    for (std::size_t i = 0; i < scale.size(); ++i) {
      scale[i] /= std::sqrt(variance[i]);
      shift[i] -= mean[i] * scale[i];
    }
    folder.affine(scale, shift);
  };
  const auto add_linear = [&](std::int64_t outputs) {
    const std::string prefix = "layers." + std::to_string(place++) + ".";
    folder.add_linear(numbers(prefix + "weight", {outputs, width}), numbers(prefix + "bias", {outputs}));
    width = outputs;
  };
  add_batch_norm();
  if (config.input_relu) folder.add_relu();
  for (const std::int64_t hidden : config.hidden) {
    add_linear(hidden);
    add_batch_norm();
    folder.add_relu();
    ++place;
  }
  const std::int64_t states = data::state_size(rows.state);
  add_linear(config.components > 0 ? config.mixture(rows.state).outputs() : states);
  if (config.components == 0)
    folder.affine(numbers("output_std", {states}), numbers("output_mean", {states}));
  std::vector<LinearLayer> layers = folder.layers();
  for (const LinearLayer& layer : layers) {
    const auto finite = [](float value) { return std::isfinite(value); };
    if (!std::all_of(layer.weight.begin(), layer.weight.end(), finite) ||
        !std::all_of(layer.bias.begin(), layer.bias.end(), finite))
      throw common::CheckpointError(what +
                                    ": its weights and normalisers together are too large for float32");
  }
  return layers;
}

}  // namespace

FoldedDynamics::FoldedDynamics(const Arrays& weights, const DynamicsConfig& config,
                               const data::RowLayout& rows, const std::string& what)
    : state_size_(data::state_size(rows.state)),
      action_size_(rows.action_size),
      predicts_change_(config.predicts_change()),
      sine_cosine_(config.sine_cosine(rows.state)),
      sees_an_eighth_(can_be_turned(config, rows, what)),
      tells_view_(config.tells_view()),
      sees_drive_by_needle_(config.sees_drive_by_needle(rows)),
      mixture_(config.mixture(rows.state)),
      layers_(fold(weights, config, rows, what)),
      network_(layers_),
      output_mean_(static_cast<std::size_t>(state_size_), 0.0F),
      output_std_(static_cast<std::size_t>(state_size_), 1.0F) {
  if (config.components == 0) return;
  output_mean_ = weight_at(weights, "output_mean", {state_size_}, what).to_vector<float>();
  output_std_ = weight_at(weights, "output_std", {state_size_}, what).to_vector<float>();
}

void FoldedDynamics::write_features(const double* state, const double* drive, std::int64_t rows,
                                    float* out) const {
  double seen[3], drive_seen[2];
  for (std::int64_t row = 0; row < rows; ++row, state += state_size_, drive += action_size_) {
    const double* from = state;
    const double* by = drive;
    const geometry::SquareView seen_in = view(state);
    if (sees_an_eighth_) {
      enter(seen_in, state, seen);
      std::copy_n(drive, 2, drive_seen);
      seen_in.enter(drive_seen);
      from = seen;
      by = drive_seen;
    }
    *out++ = static_cast<float>(from[0]);
    *out++ = static_cast<float>(from[1]);
    float sine = 0.0F, cosine = 0.0F;
    if (sine_cosine_) {
      *out++ = sine = std::sin(static_cast<float>(from[2]));
      *out++ = cosine = std::cos(static_cast<float>(from[2]));
    } else if (state_size_ == 3) {
      *out++ = static_cast<float>(from[2]);
    }
    if (tells_view_) {
      seen_in.write_view(out);
      out += geometry::SquareView::kViewNumbers;
    }
    if (sees_drive_by_needle_) {
      const auto x = static_cast<float>(by[0]), y = static_cast<float>(by[1]);
      *out++ = x * cosine + y * sine;
      *out++ = y * cosine - x * sine;
    }
    for (int i = 0; i < action_size_; ++i) *out++ = static_cast<float>(by[i]);
  }
}

void FoldedDynamics::slope_by_drive(const double* state, const float* by_feature, double* by_drive) const {
  const float* of_drive = by_feature + network_.inputs() - action_size_;
  for (int i = 0; i < action_size_; ++i) by_drive[i] = static_cast<double>(of_drive[i]);
  if (sees_drive_by_needle_) {
    const double heading_rad = sees_an_eighth_ ? view(state).entered_rad(state[2]) : state[2];
    const double sine = std::sin(heading_rad), cosine = std::cos(heading_rad);
    const double along = static_cast<double>(of_drive[-2]), across = static_cast<double>(of_drive[-1]);
    by_drive[0] += along * cosine - across * sine;
    by_drive[1] += along * sine + across * cosine;
  }
  if (sees_an_eighth_) view(state).leave(by_drive);
}

void FoldedDynamics::enter(const geometry::SquareView& view, const double* state, double* seen) const {
  std::copy_n(state, state_size_, seen);
  view.enter(seen);
  if (state_size_ == 3) seen[2] = view.entered_rad(seen[2]);
}

void FoldedDynamics::write_next(const double* state, const float* output, std::int64_t rows,
                                double* next) const {
  const auto size = static_cast<std::size_t>(state_size_);
  const double keep = predicts_change_ ? 1.0 : 0.0;
  double seen[3];
  for (std::int64_t row = 0; row < rows; ++row, state += size, output += size, next += size) {
    const geometry::SquareView seen_in = view(state);
    const double* from = state;
    if (sees_an_eighth_) {
      enter(seen_in, state, seen);
      from = seen;
    }
    for (std::size_t i = 0; i < size; ++i)
      next[i] = keep * from[i] + static_cast<double>(output_mean_[i] + output_std_[i] * output[i]);
    if (sees_an_eighth_) seen_in.leave(next);
    if (size == 3) next[2] = sees_an_eighth_ ? seen_in.left_rad(next[2]) : geometry::wrap_angle(next[2]);
  }
}

const float* FoldedDynamics::evaluate(const double* state, const double* drive, std::int64_t rows,
                                      Workspace& workspace) const {
  write_features(state, drive, rows, network_.input(rows, workspace));
  return network_.forward(rows, workspace);
}

void FoldedDynamics::predict(const double* state, const double* drive, std::int64_t rows, double* next,
                             Workspace& workspace) const {
  if (rows == 0) return;
  const float* output = evaluate(state, drive, rows, workspace);
  if (mixture_.components == 0) return write_next(state, output, rows, next);
  float mean[3];
  for (std::int64_t row = 0; row < rows; ++row) {
    mixture_mean(output + row * mixture_.outputs(), mixture_, mean);
    write_next(state + row * state_size_, mean, 1, next + row * state_size_);
  }
}

template <class LuckOf>
void FoldedDynamics::draw(const double* state, const double* drive, std::int64_t rows, const LuckOf& luck_of,
                          double* next, Workspace& workspace) const {
  if (mixture_.components == 0) return predict(state, drive, rows, next, workspace);
  if (rows == 0) return;
  const float* output = evaluate(state, drive, rows, workspace);
  float drawn[3];
  for (std::int64_t row = 0; row < rows; ++row) {
    mixture_draw(output + row * mixture_.outputs(), mixture_, luck_of(row), drawn);
    write_next(state + row * state_size_, drawn, 1, next + row * state_size_);
  }
}

void FoldedDynamics::sample(const double* state, const double* drive, std::int64_t rows,
                            common::RandomStream* const* random, double* next, Workspace& workspace) const {
  const auto own = [&](std::int64_t row) { return Luck::draw(mixture_.size, *random[row]); };
  draw(state, drive, rows, own, next, workspace);
}

void FoldedDynamics::sample(const double* state, const double* drive, std::int64_t rows, const Luck& luck,
                            double* next, Workspace& workspace) const {
  draw(
      state, drive, rows, [&](std::int64_t) { return luck; }, next, workspace);
}

void FoldedDynamics::log_density(const double* state, const double* drive, const double* seen,
                                 const double* noise, std::int64_t rows, double* out,
                                 Workspace& workspace) const {
  LODESTONE_CHECK(distribution(), "a simulator that predicts distributions");
  if (rows != 0) log_density(state, evaluate(state, drive, rows, workspace), seen, noise, rows, out);
}

void FoldedDynamics::predict_distribution(const double* state, const double* drive, std::int64_t rows,
                                          float* output, Workspace& workspace) const {
  LODESTONE_CHECK(distribution(), "a simulator that predicts distributions");
  if (rows != 0) std::copy_n(evaluate(state, drive, rows, workspace), rows * mixture_.outputs(), output);
}

PredictedMixture FoldedDynamics::predict_mixture(const double* state, const double* drive, std::int64_t rows,
                                                 Workspace& workspace) const {
  const auto size = static_cast<std::size_t>(state_size_);
  PredictedMixture mixture;
  mixture.components = std::max<std::int64_t>(1, mixture_.components);
  const auto components = static_cast<std::size_t>(mixture.components);
  mixture.weight.assign(static_cast<std::size_t>(rows) * components, 1.0);
  mixture.mean.resize(mixture.weight.size() * size);
  mixture.spread.assign(mixture.weight.size() * size, 0.0);
  if (rows == 0) return mixture;
  const float* output = evaluate(state, drive, rows, workspace);
  if (!distribution()) {
    write_next(state, output, rows, mixture.mean.data());
    return mixture;
  }
  std::vector<float> weight(components);
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row, output += mixture_.outputs()) {
    mixture_weights(output, mixture_, weight.data());
    std::copy(weight.begin(), weight.end(), &mixture.weight[row * components]);
    const float* mean = output + components;
    const float* spread = mean + components * size;
    for (std::size_t k = 0; k < components; ++k) {
      const std::size_t place = (row * components + k) * size;
      write_next(state + row * size, mean + k * size, 1, &mixture.mean[place]);
      for (std::size_t i = 0; i < size; ++i)
        mixture.spread[place + i] =
            mixture_spread(spread[k * size + i]) * static_cast<double>(output_std_[i]);
      if (view(state + row * size).swaps_axes()) std::swap(mixture.spread[place], mixture.spread[place + 1]);
    }
  }
  return mixture;
}

void FoldedDynamics::log_density(const double* state, const float* output, const double* seen,
                                 const double* noise, std::int64_t rows, double* out) const {
  const auto size = static_cast<std::size_t>(state_size_);
  double value[3], spread[3], from[3], to[3], off[3];
  for (std::int64_t row = 0; row < rows; ++row, state += size, seen += size, output += mixture_.outputs()) {
    double log_units = 0.0;
    std::copy_n(state, size, from);
    std::copy_n(seen, size, to);
    std::copy_n(noise, size, off);
    if (sees_an_eighth_) {
      const geometry::SquareView seen_in = view(state);
      enter(seen_in, state, from);
      enter(seen_in, seen, to);
      if (seen_in.swaps_axes()) std::swap(off[0], off[1]);
    }
    for (std::size_t i = 0; i < size; ++i) {
      const double change = predicts_change_ ? to[i] - from[i] : to[i];
      const auto unit = static_cast<double>(output_std_[i]);
      value[i] =
          ((i == 2 ? geometry::wrap_angle(change) : change) - static_cast<double>(output_mean_[i])) / unit;
      spread[i] = off[i] / unit;
      log_units += std::log(unit);
    }
    out[row] = mixture_log_density(output, mixture_, value, spread) - log_units;
  }
}

}  // namespace lodestone::inference
