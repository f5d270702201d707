#include "td3_networks.h"

#include <utility>
#include <vector>

#include <ATen/ops/zeros_like.h>

#include "lodestone/nets/optimiser.h"

namespace lodestone::rl {
namespace {

template <class Real>
FlatNetwork<Real> drawn_network(std::int64_t inputs, const std::vector<std::int64_t>& hidden,
                                std::int64_t outputs, common::RandomStream random) {
  FlatNetwork<Real> network(layer_widths(inputs, hidden, outputs));
  network.initialise(random);
  return network;
}

}  // namespace

template <class Real>
Learner<Real>::Learner(FlatNetwork<Real> drawn)
    : network(std::move(drawn)),
      target(network.clone()),
      first_moment(at::zeros_like(network.parameters())),
      second_moment(at::zeros_like(network.parameters())) {}

template <class Real>
void Learner<Real>::adam(const at::Tensor& gradient, double learning_rate, std::int64_t step,
                         std::int64_t begin, std::int64_t end) {
  nets::adam_step(network.parameters().template data_ptr<Real>() + begin, gradient.data_ptr<Real>() + begin,
                  first_moment.data_ptr<Real>() + begin, second_moment.data_ptr<Real>() + begin,
                  static_cast<std::size_t>(end - begin), learning_rate, step);
}

template <class Real>
void Learner<Real>::polyak(double tau, std::int64_t begin, std::int64_t end) {
  nets::polyak_step<Real>(target.parameters().template data_ptr<Real>() + begin,
                          network.parameters().template data_ptr<Real>() + begin,
                          static_cast<std::size_t>(end - begin), tau);
}

template <class Real>
Td3Networks<Real>::Td3Networks(const Td3Config& config, std::int64_t observation_size,
                               std::int64_t action_size, std::uint64_t seed)
    : actor(drawn_network<Real>(observation_size, config.hidden, action_size, {seed, "actor", 0})),
      critics{Learner<Real>(
                  drawn_network<Real>(observation_size + action_size, config.hidden, 1, {seed, "critic", 0})),
              Learner<Real>(drawn_network<Real>(observation_size + action_size, config.hidden, 1,
                                                {seed, "critic", 1}))},
      first_layer_{1, static_cast<int>(config.hidden.size()) + 2} {
  if (config.products != Td3Products::kBfloat16) return;
  for (Learner<Real>* learner : {&actor, &critics[0], &critics[1]}) {
    learner->network.round_products();
    learner->target.round_products();
  }
}

template <class Real>
nets::NamedTensors Td3Networks<Real>::networks() const {
  nets::NamedTensors all = actor.network.named(actor.network.parameters(), "actor.");
  all.merge(actor.target.named(actor.target.parameters(), "actor_target."));
  for (std::size_t k = 0; k < critics.size(); ++k) {
    const Learner<Real>& critic = critics[k];
    all.merge(critic.network.named(critic.network.parameters(), "critic.", first_layer_[k]));
    all.merge(critic.target.named(critic.target.parameters(), "critic_target.", first_layer_[k]));
  }
  return all;
}

template <class Real>
nets::NamedTensors Td3Networks<Real>::optimiser() const {
  nets::NamedTensors all = actor.network.named(actor.first_moment, "actor.first_moment.");
  all.merge(actor.network.named(actor.second_moment, "actor.second_moment."));
  for (std::size_t k = 0; k < critics.size(); ++k) {
    const Learner<Real>& critic = critics[k];
    all.merge(critic.network.named(critic.first_moment, "critic.first_moment.", first_layer_[k]));
    all.merge(critic.network.named(critic.second_moment, "critic.second_moment.", first_layer_[k]));
  }
  return all;
}

template struct Learner<float>;
template struct Learner<double>;
template struct Td3Networks<float>;
template struct Td3Networks<double>;

}  // namespace lodestone::rl
