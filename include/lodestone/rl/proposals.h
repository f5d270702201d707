#pragma once

#include <cstddef>
#include <cstdint>

#include "lodestone/geometry/drive.h"
#include "lodestone/rl/flat_network.h"

namespace lodestone::rl {

/// Sets the proposals of a fresh actor (inference::Actor) apart, of one strength, by the biases of the layer
/// behind its `hidden` ones: evenly around where an action has two numbers, else along one number after
/// another, to and fro. `strength`: logarithm of its odds.
void set_proposals_apart(FlatNetwork<float>& actor, std::size_t hidden, std::int64_t action_size,
                         std::int64_t proposals, float strength);

/// How well an actor with proposals (inference::Actor) gives an action that somebody else has chosen: the
/// proposal nearest to it comes nearer still, and the scores learn to name that one (or resting, where the
/// action is zero). So of two ways to a target each has a proposal of its own, where a mean would lie between
/// them (compare Guzman-Rivera et al., Multiple choice learning, 2012).
///
/// `output` is a row of the actor's last layer, for `proposals` proposals; writes the loss' gradient times
/// `weight` there, Actor::outputs() numbers. Returns the loss: (1 - cos of the angle between) / kDirection +
/// (difference of the logarithms of the strengths)^2 / 2 kStrength^2, and the cross-entropies of whether to
/// rest and of which proposal.
double imitate(const float* output, std::int64_t proposals, const geometry::Drive& action, double weight,
               float* gradient);

}  // namespace lodestone::rl
