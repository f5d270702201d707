#include "lodestone/env/throughput.h"

#include <algorithm>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/common/random.h"

namespace lodestone::env {
namespace {

std::vector<torch::Tensor> random_actions(const EnvSpec& spec) {
  constexpr int kBatches = 8;
  common::RandomStream random(1, "throughput actions");
  std::vector<torch::Tensor> actions;
  for (int batch = 0; batch < kBatches; ++batch) {
    torch::Tensor action = torch::empty({spec.count, spec.action_size});
    float* values = action.data_ptr<float>();
    for (std::int64_t i = 0; i < action.numel(); ++i)
      values[i] = static_cast<float>(random.uniform(-1.0, 1.0));
    actions.push_back(action);
  }
  return actions;
}

double seconds_for(VecEnv& environments, const std::vector<torch::Tensor>& actions, std::int64_t calls) {
  const common::SteadyClock clock;
  const double start_s = clock.now_s();
  for (std::int64_t call = 0; call < calls; ++call) {
    environments.step(actions[static_cast<std::size_t>(call) % actions.size()]);
  }
  return clock.now_s() - start_s;
}

}  // namespace

Throughput measure_throughput(VecEnv& environments, double seconds_per_repeat, std::int64_t repeats) {
  const torch::NoGradGuard no_grad;
  const EnvSpec spec = environments.spec();
  const std::vector<torch::Tensor> actions = random_actions(spec);
  constexpr std::int64_t kWarmUpCalls = 10;
  const double warm_up_s = seconds_for(environments, actions, kWarmUpCalls);
  const auto calls = std::max<std::int64_t>(
      1, static_cast<std::int64_t>(seconds_per_repeat / std::max(1e-9, warm_up_s / kWarmUpCalls)));
  std::vector<double> rates;
  for (std::int64_t repeat = 0; repeat < repeats; ++repeat) {
    rates.push_back(static_cast<double>(calls * spec.count) / seconds_for(environments, actions, calls));
  }
  std::sort(rates.begin(), rates.end());
  return {rates[rates.size() / 2], rates.front(), rates.back(), repeats, calls * spec.count};
}

}  // namespace lodestone::env
