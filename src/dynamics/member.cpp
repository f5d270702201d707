#include "member.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <ATen/TensorOperators.h>
#include <ATen/core/grad_mode.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/huber_loss.h>
#include <ATen/ops/mse_loss.h>
#include <ATen/ops/zeros_like.h>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/dynamics/mixture.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/nets/optimiser.h"
#include "symmetry.h"

namespace lodestone::dynamics {
namespace {

constexpr double kNoLossYet = 1e300;  // JSON has no infinity

}  // namespace

Member::Member(std::shared_ptr<Network> network, const RowTensors& train, const RowTensors& validation,
               const TrainingConfig& config, std::uint64_t seed, std::int64_t index)
    : network_(std::move(network)),
      config_(config),
      seed_(common::derive_seed(seed, "dynamics training", static_cast<std::uint64_t>(index))),
      best_loss_(kNoLossYet) {
  const at::NoGradGuard no_grad;
  network_->tensors().flatten();
  first_moment_ = at::zeros_like(network_->tensors().values());
  second_moment_ = at::zeros_like(network_->tensors().values());
  rows_ = train.size();
  std::vector<at::Tensor> inputs, targets;
  for (int way = 0; way < ways_of(config.symmetry); ++way) {
    const at::Tensor state = seen(train.state, way);
    inputs.push_back(network_->normalised_input(state, seen(train.action, way)));
    targets.push_back(network_->normalised_target(state, seen(train.next_state, way)));
  }
  input_ = at::cat(inputs);
  target_ = at::cat(targets);
  validation_input_ = network_->normalised_input(validation.state, validation.action);
  validation_target_ = network_->normalised_target(validation.state, validation.next_state);
  // Only whole batches: a last batch of a row or two would upset batch normalisation. Each epoch drops other
  // rows.
  config_.batch_size = std::min(config_.batch_size, rows_);
  steps_per_epoch_ = rows_ / config_.batch_size;
}

at::Tensor Member::epoch_order(std::int64_t epoch) const {
  const auto count = static_cast<std::size_t>(rows_);
  at::Tensor order = at::empty({rows_}, at::kLong);
  std::int64_t* rows = order.data_ptr<std::int64_t>();
  std::iota(rows, rows + count, 0);
  if (config_.bootstrap) {
    common::RandomStream draw(seed_, "bootstrap");
    for (std::size_t i = 0; i < count; ++i) rows[i] = static_cast<std::int64_t>(draw.below(count));
  }
  common::RandomStream shuffle(seed_, "order", static_cast<std::uint64_t>(epoch));
  for (std::size_t i = count - 1; i > 0; --i) std::swap(rows[i], rows[shuffle.below(i + 1)]);
  const auto ways = static_cast<std::uint64_t>(ways_of(config_.symmetry));
  if (ways > 1) {
    common::RandomStream way(seed_, "ways", static_cast<std::uint64_t>(epoch));
    for (std::size_t i = 0; i < count; ++i) rows[i] += rows_ * static_cast<std::int64_t>(way.below(ways));
  }
  return order;
}

double Member::learning_rate() const {
  if (config_.schedule == Schedule::kConstant) return config_.learning_rate;
  const auto total = static_cast<double>(steps_per_epoch_ * config_.epochs);
  return config_.learning_rate * 0.5 * (1.0 + std::cos(geometry::kPi * static_cast<double>(steps_) / total));
}

void Member::run_epoch(std::int64_t epoch) {
  if (stopped()) return;
  const at::Tensor order = epoch_order(epoch);
  const at::Tensor input = input_.index_select(0, order);
  const at::Tensor target = target_.index_select(0, order);
  network_->train(true);
  double sum = 0.0;
  for (std::int64_t step = 0; step < steps_per_epoch_; ++step) {
    const std::int64_t first = step * config_.batch_size;
    sum += train_batch(input.narrow(0, first, config_.batch_size),
                       target.narrow(0, first, config_.batch_size), learning_rate());
  }
  train_loss_ = sum / static_cast<double>(steps_per_epoch_);
  validation_loss_ = validation_error();
  if (validation_loss_ < best_loss_) {
    best_loss_ = validation_loss_;
    stale_epochs_ = 0;
    best_ = network_->tensors().named();
    for (auto& entry : best_) entry.second = entry.second.clone();
  } else {
    ++stale_epochs_;
  }
}

double Member::train_batch(const at::Tensor& input, const at::Tensor& target, double rate) {
  network_->tensors().gradient().zero_();
  const at::Tensor output = network_->layers(input);
  const at::Tensor loss = network_->mixture().components > 0
                              ? mixture_loss(output, target, network_->mixture(), config_.mean_weight)
                          : config_.loss == Loss::kHuber
                              ? at::huber_loss(output, target, at::Reduction::Mean, config_.huber_delta)
                              : at::mse_loss(output, target);
  loss.backward();
  optimiser_step(rate);
  const double value = loss.item<double>();
  if (!std::isfinite(value)) {
    throw common::Error("training of the dynamics diverged at step " + std::to_string(steps_) +
                        " (its loss is not finite); lower training.learning_rate");
  }
  return value;
}

void Member::optimiser_step(double rate) {
  ++steps_;
  at::Tensor& parameters = network_->tensors().values();
  const auto count = static_cast<std::size_t>(parameters.numel());
  auto* values = parameters.data_ptr<float>();
  auto* gradient = network_->tensors().gradient().data_ptr<float>();
  if (config_.weight_decay > 0.0) {
    if (config_.optimiser == Optimiser::kAdamW) {
      parameters.mul_(1.0 - rate * config_.weight_decay);
    } else {
      nets::add_scaled(gradient, values, count, config_.weight_decay);
    }
  }
  if (config_.optimiser == Optimiser::kSgd) {
    nets::momentum_step(values, gradient, first_moment_.data_ptr<float>(), count, rate, config_.momentum);
  } else {
    nets::adam_step(values, gradient, first_moment_.data_ptr<float>(), second_moment_.data_ptr<float>(),
                    count, rate, steps_);
  }
}

double Member::validation_error() {
  constexpr std::int64_t kChunk = 4096;
  const at::NoGradGuard no_grad;
  network_->train(false);
  double sum = 0.0;
  for (std::int64_t first = 0; first < validation_input_.size(0); first += kChunk) {
    const std::int64_t rows = std::min(kChunk, validation_input_.size(0) - first);
    const at::Tensor output = network_->layers(validation_input_.narrow(0, first, rows));
    const at::Tensor target = validation_target_.narrow(0, first, rows);
    sum += network_->mixture().components > 0
               ? mixture_loss(output, target, network_->mixture(), config_.mean_weight).item<double>() *
                     static_cast<double>(target.numel())
               : (output - target).square().sum().item<double>();
  }
  return sum / static_cast<double>(validation_target_.numel());
}

void Member::finish() {
  if (config_.keep_best && !best_.empty()) network_->tensors().load(best_, "best weights");
  network_->train(false);
}

nets::NamedTensors Member::tensors() const {
  nets::NamedTensors all;
  for (const auto& [name, tensor] : network_->tensors().named()) all["now/" + name] = tensor;
  for (const auto& [name, tensor] : best_) all["best/" + name] = tensor;
  all["first_moment"] = first_moment_;
  all["second_moment"] = second_moment_;
  return all;
}

common::Json Member::facts() const {
  return {{"steps", steps_},
          {"stale_epochs", stale_epochs_},
          {"train_loss", train_loss_},
          {"validation_loss", validation_loss_},
          {"best_loss", best_loss_}};
}

void Member::restore(const nets::NamedTensors& tensors, const common::Json& facts, const std::string& what) {
  nets::NamedTensors now;
  best_.clear();
  for (const auto& [name, tensor] : tensors) {
    if (name.rfind("now/", 0) == 0) now[name.substr(4)] = tensor;
    if (name.rfind("best/", 0) == 0) best_[name.substr(5)] = tensor;
  }
  network_->tensors().load(now, what);
  for (auto [name, moment] : {std::pair<const char*, at::Tensor*>{"first_moment", &first_moment_},
                              std::pair<const char*, at::Tensor*>{"second_moment", &second_moment_}}) {
    const auto found = tensors.find(name);
    if (found == tensors.end() || found->second.sizes() != moment->sizes()) {
      throw common::CheckpointError(what + ": tensor \"" + name + "\" is missing or of another shape");
    }
    moment->copy_(found->second);
  }
  steps_ = facts.at("steps").get<std::int64_t>();
  stale_epochs_ = facts.at("stale_epochs").get<std::int64_t>();
  train_loss_ = facts.at("train_loss").get<double>();
  validation_loss_ = facts.at("validation_loss").get<double>();
  best_loss_ = facts.at("best_loss").get<double>();
}

}  // namespace lodestone::dynamics
