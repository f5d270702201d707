#include "lodestone/rl/policy_evaluation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lodestone/common/statistics.h"
#include "lodestone/runs/curves.h"

namespace lodestone::rl {

common::Scalars scalars_of(const PolicyScore& score) {
  return {{runs::curves::kReturn, score.episode_return},
          {runs::curves::kSuccess, score.success_rate},
          {runs::curves::kEpisodeEndError, score.episode_end_error_mm},
          {runs::curves::kEpisodeEndErrorMedian, score.episode_end_error_median_mm},
          {runs::curves::kEpisodeLength, score.episode_length},
          {runs::curves::kSaturation, score.action_saturation}};
}

PolicyEvaluation::PolicyEvaluation(env::VecEnv& environments, const task::EncoderConfig& encoder)
    : environments_(environments), encoder_(encoder), start_(environments.save()) {}

PolicyScore PolicyEvaluation::run(const inference::Actor& policy) {
  environments_.load(start_);
  std::vector<float> observation = environments_.reset();
  const std::int64_t count = environments_.spec().count;
  const std::int64_t columns = environments_.spec().observation_size;
  std::vector<std::uint8_t> done(static_cast<std::size_t>(count), 0);
  std::vector<std::uint8_t> reached(static_cast<std::size_t>(count), 0);
  std::vector<double> error_mm(static_cast<std::size_t>(count), 0.0);
  double returns = 0.0;
  double steps = 0.0;
  double saturated = 0.0;
  const std::int64_t width = environments_.spec().action_size;
  std::vector<float> action(static_cast<std::size_t>(count * width));
  inference::Actor::Workspace workspace;
  for (std::int64_t left = count; left > 0;) {
    policy.act(observation.data(), count, action.data(), workspace);
    const env::StepResult& result = environments_.step(action);
    const float* chosen = action.data();
    for (std::int64_t i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (done[k] != 0) continue;
      returns += result.reward[k];
      steps += 1.0;
      for (std::int64_t j = 0; j < width; ++j)
        saturated += std::abs(chosen[i * width + j]) > kSaturatedAction ? 1.0 : 0.0;
      if (result.success[k] != 0) reached[k] = 1;
      if (result.terminated[k] == 0 && result.truncated[k] == 0) continue;
      done[k] = 1;
      --left;
      error_mm[k] = 1e3 * encoder_.target_distance_m(result.final_observation.data() + i * columns);
    }
    observation = result.observation;
  }
  const auto episodes = static_cast<double>(count);
  PolicyScore score;
  score.episodes = count;
  score.episode_return = returns / episodes;
  score.episode_length = steps / episodes;
  score.action_saturation = saturated / (steps * static_cast<double>(environments_.spec().action_size));
  score.success_rate = static_cast<double>(std::count(reached.begin(), reached.end(), 1)) / episodes;
  for (const double value : error_mm) score.episode_end_error_mm += value / episodes;
  score.episode_end_error_median_mm = common::median(error_mm);
  return score;
}

}  // namespace lodestone::rl
