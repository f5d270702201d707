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
  std::vector<std::int64_t> data_sizes = {2000, 8000};
  std::int64_t paper_epochs = 200;
  std::int64_t best_epochs = 120;
  std::int64_t centre_steps = 500000;   // section V-B
  std::int64_t target_steps = 2500000;  // likewise
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
    v.field("transitions", transitions, "", "pulses of each of the two recordings, by camera", {100, 1e9});
    v.field("data_sizes", data_sizes, "", "smaller amounts of data, in the ablations", {100, 1e9});
    v.field("paper_epochs", paper_epochs, "", "epochs of the paper's dynamics", {1, 100000});
    v.field("best_epochs", best_epochs, "", "epochs of the best preset's dynamics", {1, 100000});
    v.field("centre_steps", centre_steps, "steps", "training of every policy for the centre", {1000, 1e12});
    v.field("target_steps", target_steps, "steps", "training of every policy for random targets",
            {1000, 1e12});
    v.field("mix_steps", mix_steps, "steps", "training on mixes with recorded steps", {1000, 1e12});
    v.field("ablation_steps", ablation_steps, "steps", "training in the ablations", {1000, 1e12});
    v.field("trials", trials, "",
            "trials of each training seed, each on a rig of its own that nobody has seen", {1, 100000});
    v.field("ablation_trials", ablation_trials, "", "the same in the ablations", {1, 100000});
  }
};

/// Every run of section V at a scale, each after those it needs, training seed by training seed. Runs have
/// different seeds; the transfer cells of one task and training seed have the same one, so that every row
/// meets the same starts, targets and rigs.
runs::Plan paper_plan(const PaperScale& scale);

/// The same trainings as Table I's, begun and broken off, to be run one at a time with nothing beside them:
/// how fast they are does not depend on what their simulators have learned from, which is little here.
runs::Plan paper_pace_plan(const PaperScale& scale);

}  // namespace lodestone::experiments
