#include "lodestone/inference/actor_critic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lodestone/common/error.h"

namespace lodestone::inference {
namespace {

/// Of a vector with a direction.
constexpr float kLeastLength = 1e-6F;

/// Layers l<first>, l<first + 1>, ... of the widths from input to output.
std::vector<LinearLayer> layers_from(const Arrays& weights, std::int64_t inputs,
                                     std::vector<std::int64_t> widths, std::int64_t outputs, int first,
                                     const std::string& what) {
  widths.push_back(outputs);
  std::vector<LinearLayer> layers;
  for (const std::int64_t width : widths) {
    const std::string name = "l" + std::to_string(first++);
    layers.push_back({weight_at(weights, name + ".weight", {width, inputs}, what).to_vector<float>(),
                      weight_at(weights, name + ".bias", {width}, what).to_vector<float>()});
    inputs = width;
  }
  return layers;
}

}  // namespace

Actor::Actor(const Arrays& weights, std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
             std::int64_t action_size, const std::string& what, std::int64_t proposals)
    : action_size_(action_size),
      proposals_(proposals),
      network_(layers_from(weights, observation_size, hidden, outputs(action_size, proposals), 1, what)) {
  LODESTONE_CHECK(action_size >= 1 && action_size <= geometry::kMostDrives, "an action of 1 to 16 numbers");
}

std::int64_t Actor::choose(const float* output, std::int64_t action_size, std::int64_t proposals) {
  const float* score = output + (action_size + 1) * proposals;
  return std::max_element(score, score + proposals + 1) - score;
}

void Actor::propose(const float* output, std::int64_t action_size, std::int64_t k, float* action) {
  const float* towards = output + (action_size + 1) * k;
  const double square = std::accumulate(towards, towards + action_size, 0.0, [](double sum, float number) {
    return sum + static_cast<double>(number) * static_cast<double>(number);
  });
  const float length = std::max(kLeastLength, static_cast<float>(std::sqrt(square)));
  const float strength =
      static_cast<float>(most_strength(action_size)) / (1.0F + std::exp(-towards[action_size]));
  for (std::int64_t i = 0; i < action_size; ++i)
    action[i] = std::clamp(strength * towards[i] / length, -1.0F, 1.0F);
}

void Actor::act(const float* observation, std::int64_t rows, float* action, Workspace& workspace) const {
  std::copy_n(observation, rows * observation_size(), network_.input(rows, workspace));
  const float* output = network_.forward(rows, workspace);
  if (proposals_ == 0) {
    std::transform(output, output + rows * action_size_, action, [](float x) { return std::tanh(x); });
    return;
  }
  for (std::int64_t row = 0; row < rows; ++row, output += network_.outputs(), action += action_size_) {
    const std::int64_t chosen = choose(output, action_size_, proposals_);
    std::fill_n(action, action_size_, 0.0F);
    if (chosen < proposals_) propose(output, action_size_, chosen, action);
  }
}

std::vector<geometry::Drive> Actor::ranked(const float* observation, Workspace& workspace) const {
  std::array<float, geometry::kMostDrives> action{};
  const auto given = [&action, this] {
    return geometry::as_drive(action.data(), static_cast<int>(action_size_));
  };
  if (proposals_ == 0) {
    act(observation, 1, action.data(), workspace);
    return {given()};
  }
  std::copy_n(observation, observation_size(), network_.input(1, workspace));
  const float* output = network_.forward(1, workspace);
  LODESTONE_CHECK(std::all_of(output, output + network_.outputs(), [](float x) { return std::isfinite(x); }),
                  "finite proposals and scores from the policy network");
  const float* score = output + (action_size_ + 1) * proposals_;
  std::vector<std::int64_t> order(static_cast<std::size_t>(proposals_) + 1);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [score](std::int64_t a, std::int64_t b) { return score[a] > score[b]; });
  std::vector<geometry::Drive> actions;
  for (const std::int64_t k : order) {
    action = {};
    if (k < proposals_) propose(output, action_size_, k, action.data());
    actions.push_back(given());
  }
  return actions;
}

TwinCritic::TwinCritic(const Arrays& weights, std::int64_t observation_size,
                       const std::vector<std::int64_t>& hidden, std::int64_t action_size,
                       const std::string& what)
    : observation_size_(observation_size),
      action_size_(action_size),
      first_(layers_from(weights, observation_size + action_size, hidden, 1, 1, what)),
      second_(layers_from(weights, observation_size + action_size, hidden, 1,
                          static_cast<int>(hidden.size()) + 2, what)) {}

void TwinCritic::evaluate(const float* observation, const float* action, std::int64_t rows, float* first,
                          float* second, Workspace& workspace) const {
  float* input = first_.input(rows, workspace);
  for (std::int64_t row = 0; row < rows; ++row) {
    input = std::copy_n(observation + row * observation_size_, observation_size_, input);
    input = std::copy_n(action + row * action_size_, action_size_, input);
  }
  std::copy_n(first_.forward(rows, workspace), rows, first);
  std::copy_n(second_.forward(rows, workspace), rows, second);
}

}  // namespace lodestone::inference
