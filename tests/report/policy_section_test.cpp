#include <catch2/catch.hpp>

#include "../../src/report/sections.h"
#include "report/small_run.h"

using lodestone::tests::holds;

TEST_CASE("training is told in a sentence and drawn, or missing") {
  lodestone::report::RunData run;
  CHECK(holds(lodestone::report::policy_section(run.policy, run.trained, "p"), "lodestone train-policy"));
  run.trained.emplace().env_steps = 5000;
  run.trained->train_seconds = 10.0;
  run.policy.metrics = {{{"step", 1000}, {"evaluation/success_rate", 0.5}},
                        {{"step", 5000}, {"evaluation/success_rate", 0.75}}};
  const std::string html = lodestone::report::policy_section(run.policy, run.trained, "p");
  CHECK(holds(html, "500 steps/s"));
  CHECK(holds(html, "75 %"));
  CHECK(holds(html, "id=\"p-success\""));
  CHECK_FALSE(holds(html, "id=\"p-q\""));
}

TEST_CASE("of a policy that was chosen by its evaluations the fresh score is told") {
  lodestone::report::RunData run;
  run.policy.metrics = {{{"step", 5000}, {"evaluation/success_rate", 0.75}}};
  run.trained.emplace().fresh_evaluation.emplace().success_rate = 0.625;
  run.trained->fresh_evaluation->episodes = 256;
  const std::string html = lodestone::report::policy_section(run.policy, run.trained, "p");
  CHECK(holds(html, "256 fresh episodes"));
  CHECK(holds(html, "<b>62 %</b>"));
  CHECK_FALSE(holds(html, "<b>75 %</b>"));
}

TEST_CASE("what poses cost is told as such") {
  lodestone::report::RunData run;
  run.cost_to_go.config = {{"method", "value_iteration"}};
  run.cost_to_go.metrics = {{{"step", 5000}, {"evaluation/success_rate", 0.75}, {"train/actor_loss", 2.0}}};
  run.cost_to_go_trained.emplace().fresh_evaluation.emplace().success_rate = 0.625;
  const std::string html = lodestone::report::policy_section(run.cost_to_go, run.cost_to_go_trained, "c");
  CHECK(holds(html, "for the planner"));
  CHECK(holds(html, "<b>62 %</b> to their pose"));
  CHECK_FALSE(holds(html, "best of all evaluations"));
}
