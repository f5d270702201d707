#include "lodestone/rl/proposals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "lodestone/geometry/angle.h"
#include "lodestone/inference/actor_critic.h"

namespace lodestone::rl {
namespace {

constexpr double kDirection = 0.03;  // 1 - cos of 14 degrees
constexpr double kStrength = 0.3;    // of the logarithm
constexpr double kAlso = 0.02;       // of the gradient, to the proposals that are not the nearest

/// A proposal as the actor understands it.
struct Proposal {
  Proposal(const float* numbers, int size)
      : towards(geometry::as_drive(numbers, size)),
        length(std::max(1e-6, towards.norm())),
        direction(towards / length),
        odds(1.0 / (1.0 + std::exp(-static_cast<double>(numbers[size])))),
        most_strength(inference::Actor::most_strength(size)) {}
  double angle_part(const geometry::Drive& wanted) const {
    return (1.0 - direction.dot(wanted)) / kDirection;
  }
  double strength_off(double wanted) const { return std::log(most_strength * odds / wanted); }
  double loss(const geometry::Drive& wanted_direction, double wanted_strength) const {
    const double off = strength_off(wanted_strength) / kStrength;
    return angle_part(wanted_direction) + 0.5 * off * off;
  }

  geometry::Drive towards;
  double length;
  geometry::Drive direction;
  double odds;
  double most_strength;
};

}  // namespace

void set_proposals_apart(FlatNetwork<float>& actor, std::size_t hidden, std::int64_t action_size,
                         std::int64_t proposals, float strength) {
  nets::NamedTensors tensors = actor.named(actor.parameters(), "");
  float* bias = tensors.at("l" + std::to_string(hidden + 1) + ".bias").data_ptr<float>();
  for (std::int64_t k = 0; k < proposals; ++k, bias += action_size + 1) {
    if (action_size == 2) {
      const double angle_rad =
          2.0 * geometry::kPi * (static_cast<double>(k) + 0.5) / static_cast<double>(proposals);
      bias[0] = static_cast<float>(std::cos(angle_rad));
      bias[1] = static_cast<float>(std::sin(angle_rad));
    } else {
      bias[k / 2 % action_size] = k % 2 == 0 ? 1.0F : -1.0F;
    }
    bias[action_size] = strength;
  }
}

double imitate(const float* output, std::int64_t proposals, const geometry::Drive& action, double weight,
               float* gradient) {
  const int size = static_cast<int>(action.size());
  const double strength = std::min(action.norm(), inference::Actor::most_strength(size));
  const bool rests = strength <= 0.0;
  std::fill_n(gradient, inference::Actor::outputs(size, proposals), 0.0F);
  std::int64_t chosen = 0;
  double loss = 0.0;
  if (!rests) {
    const geometry::Drive direction = action / action.norm();
    double least = std::numeric_limits<double>::infinity();
    for (std::int64_t k = 0; k < proposals; ++k) {
      const double each = Proposal(output + (size + 1) * k, size).loss(direction, strength);
      if (each < least) {
        least = each;
        chosen = k;
      }
    }
    loss += least;
    for (std::int64_t k = 0; k < proposals; ++k) {
      const Proposal proposal(output + (size + 1) * k, size);
      float* by_proposal = gradient + (size + 1) * k;
      const double share = weight * (k == chosen ? 1.0 : kAlso);
      const geometry::Drive across = direction - direction.dot(proposal.direction) * proposal.direction;
      for (int i = 0; i < size; ++i)
        by_proposal[i] = static_cast<float>(-share * across[i] / (kDirection * proposal.length));
      const double pull = proposal.strength_off(strength) / (kStrength * kStrength) * (1.0 - proposal.odds);
      by_proposal[size] = static_cast<float>(share * std::clamp(pull, -10.0, 10.0));
    }
  }
  // Whether to rest is one question: against the best of the proposals, however many share the others' odds.
  const float* score = output + (size + 1) * proposals;
  float* by_score = gradient + (size + 1) * proposals;
  const float* most = std::max_element(score, score + proposals);
  const double gives_rest = 1.0 / (1.0 + std::exp(static_cast<double>(*most - score[proposals])));
  loss -= std::log(std::max(1e-12, rests ? gives_rest : 1.0 - gives_rest));
  const auto off = static_cast<float>(weight * (gives_rest - (rests ? 1.0 : 0.0)));
  by_score[proposals] = off;
  by_score[most - score] = -off;
  if (rests) return loss;
  // Which of them is another.
  const double sum = std::accumulate(score, score + proposals, 0.0, [most](double so_far, float each) {
    return so_far + std::exp(static_cast<double>(each - *most));
  });
  for (std::int64_t k = 0; k < proposals; ++k) {
    const double given = std::exp(static_cast<double>(score[k] - *most)) / sum;
    by_score[k] += static_cast<float>(weight * (given - (k == chosen ? 1.0 : 0.0)));
    if (k == chosen) loss -= std::log(std::max(1e-12, given));
  }
  return loss;
}

}  // namespace lodestone::rl
