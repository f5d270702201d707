#pragma once

#include <cstdint>
#include <memory>

#include <ATen/core/Tensor.h>

#include "lodestone/common/config.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/dynamics/training.h"

namespace lodestone::dynamics {

/// Training rows in physical units, float64.
struct RowTensors {
  at::Tensor state;       ///< [N, S]
  at::Tensor action;      ///< [N, A]
  at::Tensor next_state;  ///< [N, S]

  std::int64_t size() const { return state.size(0); }
};

/// One network of the ensemble while it learns. Members share nothing but constant rows, so each may have a
/// thread.
class Member {
 public:
  /// `network` has its normalisers fitted; rows are kept normalised, ready for batches.
  Member(std::shared_ptr<Network> network, const RowTensors& train, const RowTensors& validation,
         const TrainingConfig& config, std::uint64_t seed, std::int64_t index);

  /// Epoch `epoch` from 0; does nothing once stopped(). The order of rows depends on seed, member and epoch
  /// only.
  void run_epoch(std::int64_t epoch);
  bool stopped() const { return config_.patience > 0 && stale_epochs_ >= config_.patience; }
  double train_loss() const { return train_loss_; }
  double validation_loss() const { return validation_loss_; }
  double best_validation_loss() const { return best_loss_; }

  /// Takes up the best weights when the configuration says so.
  void finish();

  /// State for bitwise resumption.
  nets::NamedTensors tensors() const;
  common::Json facts() const;
  void restore(const nets::NamedTensors& tensors, const common::Json& facts, const std::string& what);

 private:
  at::Tensor epoch_order(std::int64_t epoch) const;
  double train_batch(const at::Tensor& input, const at::Tensor& target, double learning_rate);
  void optimiser_step(double learning_rate);
  double learning_rate() const;
  /// Mean squared error, or negative log-likelihood where a distribution is predicted.
  double validation_error();

  std::shared_ptr<Network> network_;
  TrainingConfig config_;
  std::uint64_t seed_;
  std::int64_t rows_;
  at::Tensor input_, target_;  ///< every row in each way to see it, way by way
  at::Tensor validation_input_, validation_target_;
  at::Tensor first_moment_, second_moment_;
  nets::NamedTensors best_;  ///< copy of the network's at the best validation loss
  std::int64_t steps_ = 0;
  std::int64_t steps_per_epoch_;
  std::int64_t stale_epochs_ = 0;
  double train_loss_ = 0.0;
  double validation_loss_ = 0.0;
  double best_loss_ = 0.0;
};

}  // namespace lodestone::dynamics
