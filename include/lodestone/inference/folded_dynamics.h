#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/geometry/square_view.h"
#include "lodestone/inference/array.h"
#include "lodestone/inference/dense_network.h"
#include "lodestone/inference/dynamics_config.h"
#include "lodestone/inference/mixture.h"

namespace lodestone::inference {

/// Next states as they are predicted, as mixtures of K Gaussians with diagonal covariance. Where a single
/// value is predicted: one component without spread.
struct PredictedMixture {
  std::int64_t components = 1;  ///< K
  std::vector<double> weight;   ///< [rows, K], each row adds up to 1
  std::vector<double> mean;     ///< [rows, K, S] in m, m and rad, headings in (-pi, pi]
  std::vector<double> spread;   ///< [rows, K, S] standard deviations in m, m and rad
};

/// A dynamics network for fast evaluation: normalisers and batch normalisation (evaluation mode) are folded
/// into the linear layers, so that a step is a few float32 matrix products into buffers that are kept. Agrees
/// with dynamics::Network::forward to rounding. predict() is const: threads share the network, each with
/// its own Workspace.
class FoldedDynamics {
 public:
  using Workspace = DenseNetwork::Workspace;

  /// `weights` as a checkpoint holds them: "input_mean", ..., "layers.0.weight", ... Throws CheckpointError
  /// that begins with `what` when they do not fit the shape.
  FoldedDynamics(const Arrays& weights, const DynamicsConfig& config, const data::RowLayout& rows,
                 const std::string& what);

  /// `state` [rows, S] (x_m, y_m[, heading_rad]) and `drive` [rows, A] in the dataset's unit, row-major;
  /// writes `next` [rows, S] (may be `state`), headings in (-pi, pi]. A row's result does not depend on the
  /// others.
  void predict(const double* state, const double* drive, std::int64_t rows, double* next,
               Workspace& workspace) const;

  /// The same with a draw from the predicted distribution instead of its mean; row i draws from `random[i]`,
  /// which may be one stream for several rows. Where a single value is predicted, that is the draw.
  void sample(const double* state, const double* drive, std::int64_t rows,
              common::RandomStream* const* random, double* next, Workspace& workspace) const;

  /// The same with the same luck for all rows.
  void sample(const double* state, const double* drive, std::int64_t rows, const Luck& luck, double* next,
              Workspace& workspace) const;

  /// Natural logarithm of the density of every state `seen` [rows, S] (per m, m and rad) in the distribution
  /// that is predicted, where a seen state has independent normal errors of `noise` [S]; writes [rows]. Only
  /// where distribution() holds.
  void log_density(const double* state, const double* drive, const double* seen, const double* noise,
                   std::int64_t rows, double* out, Workspace& workspace) const;
  /// The same in two parts: what is predicted, rows of mixture().outputs() numbers, before anything is seen,
  void predict_distribution(const double* state, const double* drive, std::int64_t rows, float* output,
                            Workspace& workspace) const;
  /// and how likely in it what was seen is.
  void log_density(const double* state, const float* output, const double* seen, const double* noise,
                   std::int64_t rows, double* out) const;

  /// The predicted distribution of the next state.
  PredictedMixture predict_mixture(const double* state, const double* drive, std::int64_t rows,
                                   Workspace& workspace) const;

  int state_size() const { return state_size_; }
  int action_size() const { return action_size_; }
  /// A distribution over changes is predicted, not a single value.
  bool distribution() const { return mixture_.components > 0; }

  /// As what lies at `state` is seen by the layers: drives go in and displacements come out in this view.
  geometry::SquareView view(const double* state) const {
    return sees_an_eighth_ ? geometry::SquareView::of(state[0], state[1]) : geometry::SquareView();
  }
  /// For what looks inside, as a gradient does: the layers from features() to numbers as mixture() lays them
  /// out, in units of output_unit() [S] (m, m and rad), all in view().
  const std::vector<LinearLayer>& layers() const { return layers_; }
  const MixtureLayout& mixture() const { return mixture_; }
  const std::vector<float>& output_unit() const { return output_std_; }
  /// What the layers take of `state` [rows, S] and `drive` [rows, A]: [rows, inputs], what tells of the drive
  /// last.
  void write_features(const double* state, const double* drive, std::int64_t rows, float* out) const;
  /// Slope by the drive, `by_drive` [A] in the unit of the dataset, of a number whose slope by the features
  /// of one state is `by_feature` [inputs].
  void slope_by_drive(const double* state, const float* by_feature, double* by_drive) const;
  /// Next states from rows of normalised numbers (already in physical units where no mixture is predicted).
  void write_next(const double* state, const float* output, std::int64_t rows, double* next) const;

 private:
  /// Row i draws with `luck_of`(i).
  template <class LuckOf>
  void draw(const double* state, const double* drive, std::int64_t rows, const LuckOf& luck_of, double* next,
            Workspace& workspace) const;
  /// Writes a state [S] as it is seen.
  void enter(const geometry::SquareView& view, const double* state, double* seen) const;
  /// Runs the layers; returns [rows, outputs], which lives in the workspace.
  const float* evaluate(const double* state, const double* drive, std::int64_t rows,
                        Workspace& workspace) const;

  int state_size_;
  int action_size_;
  bool predicts_change_;
  bool sine_cosine_;
  bool sees_an_eighth_;
  bool tells_view_;
  bool sees_drive_by_needle_;
  MixtureLayout mixture_;  // no components: a single value
  std::vector<LinearLayer> layers_;
  DenseNetwork network_;
  std::vector<float> output_mean_, output_std_;
};

}  // namespace lodestone::inference
