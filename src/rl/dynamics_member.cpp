#include "dynamics_member.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/rl/adam.h"

namespace lodestone::rl {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNoLossYet = 1e300;  // JSON has no infinity

void add_scaled(float* __restrict target, const float* __restrict source, std::int64_t count, double scale) {
  const auto factor = static_cast<float>(scale);
  for (std::int64_t i = 0; i < count; ++i) target[i] += factor * source[i];
}

}  // namespace

DynamicsMember::DynamicsMember(nets::DynamicsNetwork network, const RowTensors& train,
                               const RowTensors& validation, const DynamicsTrainingConfig& config,
                               std::uint64_t seed, std::int64_t index)
    : network_(std::move(network)),
      config_(config),
      seed_(common::derive_seed(seed, "dynamics training", static_cast<std::uint64_t>(index))),
      parameters_(*network_),
      first_moment_(torch::zeros_like(parameters_.values())),
      second_moment_(torch::zeros_like(parameters_.values())),
      best_loss_(kNoLossYet) {
  const torch::NoGradGuard no_grad;
  input_ = network_->normalised_input(train.state, train.action);
  target_ = network_->normalised_target(train.state, train.next_state);
  validation_input_ = network_->normalised_input(validation.state, validation.action);
  validation_target_ = network_->normalised_target(validation.state, validation.next_state);
  // Only whole batches: a last batch of a row or two would upset batch normalisation. Each epoch drops other
  // rows.
  config_.batch_size = std::min(config_.batch_size, input_.size(0));
  steps_per_epoch_ = input_.size(0) / config_.batch_size;
}

torch::Tensor DynamicsMember::epoch_order(std::int64_t epoch) const {
  const auto count = static_cast<std::size_t>(input_.size(0));
  torch::Tensor order = torch::empty({input_.size(0)}, torch::kInt64);
  std::int64_t* rows = order.data_ptr<std::int64_t>();
  std::iota(rows, rows + count, 0);
  if (config_.bootstrap) {
    common::RandomStream draw(seed_, "bootstrap");
    for (std::size_t i = 0; i < count; ++i) rows[i] = static_cast<std::int64_t>(draw.below(count));
  }
  common::RandomStream shuffle(seed_, "order", static_cast<std::uint64_t>(epoch));
  for (std::size_t i = count - 1; i > 0; --i) std::swap(rows[i], rows[shuffle.below(i + 1)]);
  return order;
}

double DynamicsMember::learning_rate() const {
  if (config_.schedule == "constant") return config_.learning_rate;
  const auto total = static_cast<double>(steps_per_epoch_ * config_.epochs);
  return config_.learning_rate * 0.5 * (1.0 + std::cos(kPi * static_cast<double>(steps_) / total));
}

void DynamicsMember::run_epoch(std::int64_t epoch) {
  if (stopped()) return;
  const torch::Tensor order = epoch_order(epoch);
  const torch::Tensor input = input_.index_select(0, order);
  const torch::Tensor target = target_.index_select(0, order);
  network_->train();
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
    best_ = own_state();
    for (auto& entry : best_) entry.second = entry.second.clone();
  } else {
    ++stale_epochs_;
  }
}

double DynamicsMember::train_batch(const torch::Tensor& input, const torch::Tensor& target, double rate) {
  parameters_.zero_gradient();
  const torch::Tensor output = network_->layers()->forward(input);
  const torch::Tensor loss =
      network_->mixture().components > 0 ? nets::mixture_loss(output, target, network_->mixture())
      : config_.loss == "huber" ? torch::huber_loss(output, target, at::Reduction::Mean, config_.huber_delta)
                                : torch::mse_loss(output, target);
  loss.backward();
  optimiser_step(rate);
  const double value = loss.item<double>();
  if (!std::isfinite(value)) {
    throw common::Error(
        "training of the dynamics diverged (loss is not finite); lower training.learning_rate");
  }
  return value;
}

void DynamicsMember::optimiser_step(double rate) {
  ++steps_;
  const std::int64_t count = parameters_.values().numel();
  float* values = parameters_.values().data_ptr<float>();
  float* gradient = parameters_.gradient().data_ptr<float>();
  if (config_.weight_decay > 0.0) {
    if (config_.optimiser == "adamw") {
      const auto keep = static_cast<float>(1.0 - rate * config_.weight_decay);
      for (std::int64_t i = 0; i < count; ++i) values[i] *= keep;
    } else {
      add_scaled(gradient, values, count, config_.weight_decay);
    }
  }
  if (config_.optimiser == "sgd") {
    float* velocity = first_moment_.data_ptr<float>();
    const auto momentum = static_cast<float>(config_.momentum);
    for (std::int64_t i = 0; i < count; ++i) velocity[i] = momentum * velocity[i] + gradient[i];
    add_scaled(values, velocity, count, -rate);
    return;
  }
  adam_step(values, gradient, first_moment_.data_ptr<float>(), second_moment_.data_ptr<float>(),
            static_cast<std::size_t>(count), rate, steps_);
}

double DynamicsMember::validation_error() {
  constexpr std::int64_t kChunk = 4096;
  const torch::NoGradGuard no_grad;
  network_->eval();
  double sum = 0.0;
  for (std::int64_t first = 0; first < validation_input_.size(0); first += kChunk) {
    const std::int64_t rows = std::min(kChunk, validation_input_.size(0) - first);
    const torch::Tensor output = network_->layers()->forward(validation_input_.narrow(0, first, rows));
    const torch::Tensor target = validation_target_.narrow(0, first, rows);
    sum += network_->mixture().components > 0
               ? nets::mixture_loss(output, target, network_->mixture()).item<double>() *
                     static_cast<double>(target.numel())
               : (output - target).square().sum().item<double>();
  }
  return sum / static_cast<double>(validation_target_.numel());
}

nets::NamedTensors DynamicsMember::own_state() const { return nets::module_tensors(*network_); }

void DynamicsMember::finish() {
  if (config_.keep_best && !best_.empty()) nets::load_module_tensors(*network_, best_, "best weights");
  network_->eval();
}

nets::NamedTensors DynamicsMember::tensors() const {
  nets::NamedTensors all;
  for (const auto& [name, tensor] : own_state()) all["now/" + name] = tensor;
  for (const auto& [name, tensor] : best_) all["best/" + name] = tensor;
  all["first_moment"] = first_moment_;
  all["second_moment"] = second_moment_;
  return all;
}

common::Json DynamicsMember::facts() const {
  return {{"steps", steps_},
          {"stale_epochs", stale_epochs_},
          {"train_loss", train_loss_},
          {"validation_loss", validation_loss_},
          {"best_loss", best_loss_}};
}

void DynamicsMember::restore(const nets::NamedTensors& tensors, const common::Json& facts,
                             const std::string& what) {
  nets::NamedTensors now;
  best_.clear();
  for (const auto& [name, tensor] : tensors) {
    if (name.rfind("now/", 0) == 0) now[name.substr(4)] = tensor;
    if (name.rfind("best/", 0) == 0) best_[name.substr(5)] = tensor;
  }
  nets::load_module_tensors(*network_, now, what);
  for (auto [name, moment] : {std::pair<const char*, torch::Tensor*>{"first_moment", &first_moment_},
                              std::pair<const char*, torch::Tensor*>{"second_moment", &second_moment_}}) {
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

}  // namespace lodestone::rl
