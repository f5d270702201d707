#include "lodestone/control/motion_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {
namespace {

void write_state(const geometry::Pose2& pose, std::size_t size, double* out) {
  const double numbers[3] = {pose.x_m, pose.y_m, pose.heading_rad};
  std::copy_n(numbers, size, out);
}

}  // namespace

MotionModel::MotionModel(std::shared_ptr<const LearnedSimulator> model, const IdentificationConfig& config,
                         double drive_per_A)
    : model_(std::move(model)), config_(config), drive_per_A_(drive_per_A) {
  LODESTONE_CHECK(model_->sampled, "a simulator that predicts distributions");
}

void MotionModel::write_drive(const geometry::Drive& drive_A, double* out) const {
  LODESTONE_CHECK(drive_A.size() == model_->action.size, "a drive of the simulator's size");
  const geometry::Drive drive = geometry::saturated(drive_per_A_ * drive_A, model_->action.scale);
  std::copy(drive.begin(), drive.end(), out);
}

template <class Density>
void MotionModel::judge_by(std::size_t count, const Density& density, std::vector<double>& out) {
  const std::size_t size = model_->state_size;
  log_density_.resize(count);
  out.assign(count, 0.0);
  for (std::size_t member = 0; member < model_->members.size(); ++member) {
    density(member);
    for (std::size_t k = 0; k < count; ++k)
      out[k] += std::exp(log_density_[k]) / static_cast<double>(model_->members.size());
  }
  const double turns_rad = size == 3 ? 2.0 * geometry::kPi : 1.0;
  const double outlier = 1.0 / (geometry::kPi * std::pow(model_->dish_radius_m, 2) * turns_rad);
  for (double& ratio : out) ratio = (1.0 - config_.outlier_share) * ratio / outlier + config_.outlier_share;
}

void MotionModel::predict(const geometry::Pose2& before, const std::vector<geometry::Drive>& drives_A,
                          Prediction& out) {
  const std::size_t size = model_->state_size;
  out.before = before;
  out.pulses = drives_A.size();
  out.output.resize(model_->members.size());
  state_.resize(out.pulses * size);
  const auto numbers = static_cast<std::size_t>(model_->action.size);
  drive_.resize(numbers * out.pulses);
  for (std::size_t k = 0; k < out.pulses; ++k) {
    write_state(before, size, &state_[k * size]);
    write_drive(drives_A[k], &drive_[numbers * k]);
  }
  for (std::size_t member = 0; member < model_->members.size(); ++member) {
    const inference::FoldedDynamics& dynamics = model_->members[member];
    out.output[member].resize(out.pulses * static_cast<std::size_t>(dynamics.mixture().outputs()));
    dynamics.predict_distribution(state_.data(), drive_.data(), static_cast<std::int64_t>(out.pulses),
                                  out.output[member].data(), workspace_);
  }
}

std::vector<physics::PulseOutcome> MotionModel::outcomes(const geometry::Pose2& before,
                                                         const geometry::Drive& drive_A) {
  std::vector<physics::PulseOutcome> all;
  if (model_->state_size != 3) return all;
  predict(before, {drive_A}, outcomes_);
  for (std::size_t member = 0; member < model_->members.size(); ++member) {
    const inference::FoldedDynamics& dynamics = model_->members[member];
    const inference::MixtureLayout& layout = dynamics.mixture();
    const auto components = static_cast<std::size_t>(layout.components);
    const float* raw = outcomes_.output[member].data();
    weights_.resize(components);
    inference::mixture_weights(raw, layout, weights_.data());
    for (std::size_t k = 0; k < components; ++k) {
      const float* mean = raw + components + 3 * k;
      const float* spread = mean + 3 * components;
      const auto sigma = [&](std::size_t i) {
        return inference::mixture_spread(spread[i]) * static_cast<double>(dynamics.output_unit()[i]);
      };
      double next[3];
      dynamics.write_next(state_.data(), mean, 1, next);
      physics::PulseOutcome& one = all.emplace_back();
      one.weight = static_cast<double>(weights_[k]) / static_cast<double>(model_->members.size());
      one.mean = {next[0], next[1], next[2]};
      one.sigma_x_m = sigma(0);
      one.sigma_y_m = sigma(1);
      if (dynamics.view(state_.data()).swaps_axes()) std::swap(one.sigma_x_m, one.sigma_y_m);
      one.sigma_heading_rad = std::hypot(sigma(2), config_.noise_rad);
    }
  }
  return all;
}

void MotionModel::judge(const Prediction& predicted, const geometry::Pose2& after, std::vector<double>& out) {
  const std::size_t size = model_->state_size;
  const double noise[3] = {config_.noise_m, config_.noise_m, config_.noise_rad};
  state_.resize(predicted.pulses * size);
  seen_.resize(predicted.pulses * size);
  for (std::size_t k = 0; k < predicted.pulses; ++k) {
    write_state(predicted.before, size, &state_[k * size]);
    write_state(after, size, &seen_[k * size]);
  }
  judge_by(
      predicted.pulses,
      [&](std::size_t member) {
        model_->members[member].log_density(state_.data(), predicted.output[member].data(), seen_.data(),
                                            noise, static_cast<std::int64_t>(predicted.pulses),
                                            log_density_.data());
      },
      out);
}

void MotionModel::judge(const std::vector<SeenPulse>& pulses, std::vector<double>& out) {
  const std::size_t size = model_->state_size;
  const std::size_t count = pulses.size();
  const double noise[3] = {config_.noise_m, config_.noise_m, config_.noise_rad};
  state_.resize(count * size);
  seen_.resize(count * size);
  const auto numbers = static_cast<std::size_t>(model_->action.size);
  drive_.resize(numbers * count);
  for (std::size_t k = 0; k < count; ++k) {
    write_state(pulses[k].before, size, &state_[k * size]);
    write_state(pulses[k].after, size, &seen_[k * size]);
    write_drive(pulses[k].drive_A, &drive_[numbers * k]);
  }
  judge_by(
      count,
      [&](std::size_t member) {
        model_->members[member].log_density(state_.data(), drive_.data(), seen_.data(), noise,
                                            static_cast<std::int64_t>(count), log_density_.data(),
                                            workspace_);
      },
      out);
}

geometry::Pose2 MotionModel::draw(const geometry::Pose2& before, const geometry::Drive& drive_A,
                                  common::RandomStream& random) {
  const std::size_t size = model_->state_size;
  double state[3];
  write_state(before, size, state);
  double drive[geometry::kMostDrives];
  write_drive(drive_A, drive);
  common::RandomStream* const stream = &random;
  double next[3];
  model_->members[random.below(model_->members.size())].sample(state, drive, 1, &stream, next, workspace_);
  geometry::Pose2 after = {next[0] + config_.noise_m * random.normal(),
                           next[1] + config_.noise_m * random.normal(), before.heading_rad};
  if (size == 3) after.heading_rad = geometry::wrap_angle(next[2] + config_.noise_rad * random.normal());
  return after;
}

}  // namespace lodestone::control
