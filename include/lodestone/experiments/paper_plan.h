#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/runs/plan.h"

namespace lodestone::experiments {

/// How large the paper's experiments are run: configs/bench/paper_{smoke,quick,full}.json.
struct PaperScale {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  std::int64_t seeds = 5;
  std::int64_t ablation_seeds = 5;
  std::int64_t transitions = 34742;  // section V-A
  std::int64_t second_transitions = 10000;
  std::vector<std::int64_t> data_sizes = {2000, 8000};
  std::int64_t paper_epochs = 200;
  std::int64_t best_epochs = 120;
  std::int64_t paper_steps = 500000;
  std::int64_t simulator_steps = 500000;
  std::int64_t best_centre_steps = 300000;
  std::int64_t best_target_steps = 1000000;
  std::int64_t mix_steps = 200000;
  std::int64_t ablation_steps = 500000;
  std::int64_t trials = 50;
  std::int64_t ablation_trials = 50;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of everything; each cell draws its own from it", {0, 9e15});
    v.field("threads", threads, "", "cells at the same time, one thread each; 0 means one per processor",
            {0, 1024});
    v.field("seeds", seeds, "", "training seeds of figures 4 and 5 and tables I and II", {1, 100});
    v.field("ablation_seeds", ablation_seeds, "", "training seeds of the ablations", {1, 100});
    v.field("transitions", transitions, "", "recorded by the explorer, through the camera", {100, 1e9});
    v.field("second_transitions", second_transitions, "", "recorded by a first policy, for the best preset",
            {100, 1e9});
    v.field("data_sizes", data_sizes, "", "smaller amounts of data, in the ablations", {100, 1e9});
    v.field("paper_epochs", paper_epochs, "", "epochs of the paper's dynamics", {1, 100000});
    v.field("best_epochs", best_epochs, "", "epochs of the best preset's dynamics", {1, 100000});
    v.field("paper_steps", paper_steps, "steps", "training of the paper's policies in the MBS", {1000, 1e12});
    v.field("simulator_steps", simulator_steps, "steps", "training in the plain and the randomised simulator",
            {1000, 1e12});
    v.field("best_centre_steps", best_centre_steps, "steps", "training of the best preset, centre",
            {1000, 1e12});
    v.field("best_target_steps", best_target_steps, "steps",
            "training of the best preset, random target and pose", {1000, 1e12});
    v.field("mix_steps", mix_steps, "steps", "training on mixes with recorded steps", {1000, 1e12});
    v.field("ablation_steps", ablation_steps, "steps", "training in the ablations", {1000, 1e12});
    v.field("trials", trials, "", "trials of each training seed on unseen rigs; table II pools the seeds",
            {1, 100000});
    v.field("ablation_trials", ablation_trials, "", "the same in the ablations", {1, 100000});
  }
};

/// Every run of section V at a scale, each after those it needs. Runs have different seeds; the transfer
/// cells of one task and training seed have the same one, so that every row meets the same starts, targets
/// and rigs.
runs::Plan paper_plan(const PaperScale& scale);

}  // namespace lodestone::experiments
