#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/inference/cost_to_go.h"
#include "lodestone/rl/imagined_needle.h"

namespace lodestone::rl {

/// How a cost-to-go, and a policy beside it, are learned in the learned simulator.
struct ValueIterationConfig : ImaginationConfig {
  inference::PoseCost cost;
  std::vector<std::int64_t> value_hidden = {128, 128};
  std::vector<std::int64_t> hidden = {256, 256};
  std::int64_t proposals = 4;
  double learning_rate = 1e-3;
  double polyak = 0.5;
  std::int64_t candidates = 32;
  std::int64_t refinements = 16;
  std::int64_t particles = 4;
  double weakest = 0.02;
  std::int64_t replayed = 8;
  std::int64_t updates = 24;
  double moving_goals = 0.3;
  double policy_share = 0.5;
  double rest_within = 0.9;

  ValueIterationConfig() {
    new_goal = 0.05;
    near_goals = 0.6;
  }

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("cost", cost, "what lying somewhere else than at the target costs");
    v.field("value_hidden", value_hidden, "", "width of each hidden layer of the cost-to-go", {1, 8192});
    v.field("hidden", hidden, "", "width of each hidden layer of the policy", {1, 8192});
    v.field("proposals", proposals, "", "pulses that the policy proposes, of which it gives the best one",
            {1, 64});
    v.field("learning_rate", learning_rate, "", "Adam's step size, of both networks", {0.0, 1.0});
    v.field("polyak", polyak, "",
            "the cost-to-go that pulses are judged by follows the one that learns by this share a step",
            {1e-4, 1.0});
    v.field("candidates", candidates, "",
            "pulses of any strength and direction tried at every decision, beside what the policy proposes",
            {2, 100000});
    v.field("refinements", refinements, "", "and so many near the best of them, in each of two rounds",
            {0, 100000});
    v.field("particles", particles, "", "outcomes that every pulse is judged by", {1, 1000});
    v.field("weakest", weakest, "action units", "the weakest pulse that is tried", {1e-4, 0.9});
    v.field("replayed", replayed, "decisions", "of every needle are learned from again and again",
            {1, 100000});
    v.field("updates", updates, "", "steps of Adam for every decision of the needles", {1, 1000});
    ImaginationConfig::visit(v);
    v.field(
        "moving_goals", moving_goals, "",
        "share of the goals that move along their heading, as on a path; only the policy learns from them",
        {0.0, 1.0});
    v.field(
        "policy_share", policy_share, "",
        "share of the needles that are given what the policy chose, so that it learns from where it comes "
        "to itself",
        {0.0, 1.0});
    v.field(
        "rest_within", rest_within, "",
        "the policy rests where the needle lies within this share of both tolerances, though the search may "
        "know a pulse that betters it: it does not aim as well",
        {0.0, 1.0});
  }
};

}  // namespace lodestone::rl
