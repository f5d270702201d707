#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "lodestone/common/json.h"
#include "lodestone/exports/policy_contract.h"

namespace lodestone::exports {

/// One decision that an exported policy must repeat.
struct GoldenStep {
  std::map<std::string, std::vector<float>> inputs;  ///< without the memory, which goes on from step to step
  std::array<float, 4> current_A;                    ///< what control::PolicyController comes to
};

/// Decisions one after the other; the memory is zero before the first.
using GoldenEpisode = std::vector<GoldenStep>;

/// Always the same, and all of one length: needles that move, that stay where they are whatever is tried, and
/// that turn.
std::vector<GoldenEpisode> golden_episodes(const PolicyContract& contract);

/// [[{"pose": [...], ..., "current": [...]}, ...], ...]
common::Json golden_json(const std::vector<GoldenEpisode>& episodes);

}  // namespace lodestone::exports
