#include "lodestone/inference/folded_dynamics.h"

#include <cmath>

#include "fold.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::inference {

FoldedDynamics::FoldedDynamics(const Arrays& weights, const DynamicsConfig& config, data::StateLayout layout,
                               const std::string& what)
    : state_size_(data::state_size(layout)),
      predicts_change_(config.predicts_change()),
      sine_cosine_(config.sine_cosine(layout)),
      mixture_(config.mixture(layout)),
      network_(fold(weights, config, layout, what)),
      output_mean_(static_cast<std::size_t>(state_size_), 0.0F),
      output_std_(static_cast<std::size_t>(state_size_), 1.0F) {
  if (config.components == 0) return;
  output_mean_ = weight_at(weights, "output_mean", {state_size_}, what).to_vector<float>();
  output_std_ = weight_at(weights, "output_std", {state_size_}, what).to_vector<float>();
}

void FoldedDynamics::write_features(const double* state, const double* drive, std::int64_t rows,
                                    float* out) const {
  for (std::int64_t row = 0; row < rows; ++row, state += state_size_, drive += data::kActionSize) {
    *out++ = static_cast<float>(state[0]);
    *out++ = static_cast<float>(state[1]);
    if (sine_cosine_) {
      *out++ = std::sin(static_cast<float>(state[2]));
      *out++ = std::cos(static_cast<float>(state[2]));
    } else if (state_size_ == 3) {
      *out++ = static_cast<float>(state[2]);
    }
    *out++ = static_cast<float>(drive[0]);
    *out++ = static_cast<float>(drive[1]);
  }
}

void FoldedDynamics::write_next(const double* state, const float* output, std::int64_t rows,
                                double* next) const {
  const auto size = static_cast<std::size_t>(state_size_);
  const double keep = predicts_change_ ? 1.0 : 0.0;
  for (std::int64_t row = 0; row < rows; ++row, state += size, output += size, next += size) {
    for (std::size_t i = 0; i < size; ++i)
      next[i] = keep * state[i] + static_cast<double>(output_mean_[i] + output_std_[i] * output[i]);
    if (size == 3) next[2] = geometry::wrap_angle(next[2]);
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

void FoldedDynamics::sample(const double* state, const double* drive, std::int64_t rows,
                            common::RandomStream* const* random, double* next, Workspace& workspace) const {
  if (mixture_.components == 0) return predict(state, drive, rows, next, workspace);
  if (rows == 0) return;
  const float* output = evaluate(state, drive, rows, workspace);
  float drawn[3];
  for (std::int64_t row = 0; row < rows; ++row) {
    mixture_draw(output + row * mixture_.outputs(), mixture_, *random[row], drawn);
    write_next(state + row * state_size_, drawn, 1, next + row * state_size_);
  }
}

}  // namespace lodestone::inference
