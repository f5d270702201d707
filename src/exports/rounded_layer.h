#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/exports/policy_contract.h"

namespace lodestone::exports {

/// A linear layer whose weights are whole numbers of 16 bits, times a scale for each row.
struct RoundedLayer {
  std::int64_t inputs = 0, outputs = 0;
  std::vector<std::int16_t> weight;  ///< [outputs, inputs], within +-32767
  std::vector<float> scale, bias;    ///< [outputs]
};

/// More products than this an ATmega2560 does not manage within a control period of 300 ms
/// (tests/exports/policy_on_avr_test.cpp times 73,728).
constexpr std::int64_t kMostProducts = 85'000;

std::vector<RoundedLayer> rounded_layers(const PolicyContract& contract);
/// Of a decision.
std::int64_t products(const std::vector<RoundedLayer>& layers);
/// The policy with its weights as the layers have them.
inference::Policy rounded_policy(const inference::Policy& policy, const std::vector<RoundedLayer>& layers);

}  // namespace lodestone::exports
