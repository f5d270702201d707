#pragma once

namespace lodestone::runs {

/// Names of the curves in metrics.jsonl that are written in one place and drawn in another.
namespace curves {

// train-policy, by environment steps
constexpr const char* kReturn = "evaluation/episode_return";
constexpr const char* kSuccess = "evaluation/success_rate";
constexpr const char* kEpisodeEndError = "evaluation/episode_end_error_mm";
constexpr const char* kEpisodeEndErrorMedian = "evaluation/episode_end_error_median_mm";
constexpr const char* kEpisodeLength = "evaluation/episode_length";
constexpr const char* kSaturation = "evaluation/action_saturation";
constexpr const char* kTrainReturn = "train/episode_return";
constexpr const char* kTrainSuccess = "train/success_rate";
constexpr const char* kTrainLength = "train/episode_length";
constexpr const char* kTrainSaturation = "train/action_saturation";
constexpr const char* kQ = "train/q_mean";
constexpr const char* kCriticLoss = "train/critic_loss";
constexpr const char* kActorLoss = "train/actor_loss";
constexpr const char* kTrainSeconds = "train/seconds";                ///< on the clock, so far
constexpr const char* kProcessorSeconds = "train/processor_seconds";  ///< of all threads

// train-dynamics and train-segmenter, by epoch
constexpr const char* kTrainLoss = "train_loss";
constexpr const char* kValidationLoss = "validation_loss";

}  // namespace curves

}  // namespace lodestone::runs
