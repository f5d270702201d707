#include <catch2/catch.hpp>

#include "../../src/report/sections.h"
#include "report/small_run.h"

using lodestone::tests::holds;

TEST_CASE("the overview names where each step ran, and says no more than there was") {
  lodestone::report::RunData run = lodestone::tests::small_run();
  run.deploy.name = "deploy";
  run.deploy.manifest = {{"git_commit", "0123456789abcdef"}, {"host", "a <host>"}, {"seed", 7}};
  run.deploy.manifest["continued"] = {{{"git_commit", "fedcba9876543210"}, {"threads", 4}}};
  const std::string html = lodestone::report::overview_section(run, nullptr);
  CHECK(holds(html, "0123456789ab<"));
  CHECK(holds(html, "a &lt;host&gt;"));
  CHECK(holds(html, "went on"));
  CHECK(holds(html, "fedcba987654<"));
  CHECK(holds(html, "point, explored rig, policy"));
  CHECK(holds(html, "a network learns"));
  CHECK(holds(html, "the policy then drives"));
  run.rigs.front().summary.controller = "planner";
  CHECK(holds(lodestone::report::overview_section(run, nullptr), "a planner, which tries pulses"));
  CHECK(holds(html, "by TD3"));
  run.policy.config = {{"method", "model_gradient"}};
  CHECK_FALSE(holds(lodestone::report::overview_section(run, nullptr), "by TD3"));
  run.deployment_only = true;
  CHECK_FALSE(holds(lodestone::report::overview_section(run, nullptr), "a network learns"));
}
