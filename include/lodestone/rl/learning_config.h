#pragma once

#include <cstdint>

namespace lodestone::rl {

/// How much is collected and learned.
struct LearningConfig {
  std::int64_t env_steps = 500000;
  std::int64_t warm_up_steps = 5000;
  double updates_per_step = 1.0;
  std::int64_t buffer_size = 1000000;
  double final_learning_rate = 1.0;
  double final_noise = 1.0;
  double hindsight = 0.0;
  bool overlap = false;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("env_steps", env_steps, "steps", "environment steps of the whole run, all environments together",
            {1, 1e12});
    v.field("warm_up_steps", warm_up_steps, "steps",
            "steps with random actions and without updates at the start", {0, 1e12});
    v.field("updates_per_step", updates_per_step, "updates/step",
            "updates per environment step after the warm-up", {0.0, 100.0});
    v.field("buffer_size", buffer_size, "transitions", "capacity of the replay buffer", {1, 1e9});
    v.field("final_learning_rate", final_learning_rate, "fraction",
            "learning rate at the end of the run, falling linearly; 1 keeps it", {0.0, 1.0});
    v.field("final_noise", final_noise, "fraction",
            "exploration noise at the end of the run, falling linearly; 1 keeps it", {0.0, 1.0});
    v.field("hindsight", hindsight, "",
            "hindsight relabelling: fraction of the steps that go into the buffer once more, with the goal "
            "where the needle "
            "came to",
            {0.0, 1.0});
    v.field("overlap", overlap, "",
            "environments step on a thread of their own while the learner makes the updates of the step "
            "before; worth it where a step of the environments is short beside its updates");
  }
};

}  // namespace lodestone::rl
