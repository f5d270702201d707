#include <catch2/catch.hpp>

#include "../../src/report/paper_page.h"
#include "report/kept_paper.h"

using namespace lodestone;
using tests::Kept;

TEST_CASE("a training that had not converged has no time") {
  Kept made;
  made.add_training("policy/paper/centre/1", tests::kRising);
  made.add_training("policy/best/centre/1", tests::kRisen);
  made.add("policy/best/target/1", false);
  report::PaperPage page(made.kept);
  report::add_training(page);
  CHECK(page.markdown.find("| as the paper's, MBS, centre | 1.5 h | 1\u202f900 | had not converged | – |") !=
        std::string::npos);
  CHECK(page.markdown.find("| our TD3, MBS, centre | – | 1\u202f900 | 500 | – | – | – | 50 | – | 190 |") !=
        std::string::npos);
  CHECK(page.markdown.find("| our TD3, MBS, random target | – | not run yet |") != std::string::npos);
}

TEST_CASE("where seeds differ, the lowest and the highest stand beside their mean") {
  Kept made, alone;
  std::vector<double> late = tests::kRisen;
  for (std::size_t i = 1; i < 10; ++i) late[i] = 0.0;
  made.add_training("policy/best/centre/1", tests::kRisen);
  made.add_training("policy/best/centre/2", late);
  made.kept.records["policy/best/centre/2"].policy->fresh_evaluation->success_rate = 1.0;
  alone.add_training("pace/best/centre", {0.0, 1.0, 2.0});  // 10 steps/s
  report::PaperPage page(made.kept, alone.kept);
  report::add_training(page);
  CHECK(page.markdown.find("| our TD3, MBS, centre | – | 1\u202f900 | 750 (500 to 1\u202f000) | 10 | 3 | "
                           "75 (50 to 100) | 75 | 190 | 190 | 90 % (80 to 100) |") != std::string::npos);
}

TEST_CASE("a seed that had more threads than one counts for all but the time") {
  Kept made;
  made.add_training("policy/best/centre/1", tests::kRisen);
  made.add_training("policy/best/centre/2", tests::kRisen);
  made.kept.records["policy/best/centre/2"].machine["continued"] = {{{"threads", 2}}};
  made.kept.records["policy/best/centre/2"].policy->train_seconds = 1.0;
  made.add_training("policy/best/target/1", tests::kRisen);
  made.kept.records["policy/best/target/1"].machine["threads"] = 2;
  report::PaperPage page(made.kept);
  report::add_training(page);
  CHECK(page.markdown.find(
            "| our TD3, MBS, centre | – | 1\u202f900 | 500 | – | – | – | 50 | – | 190 | 80 % | – | 1 | "
            "2 of 2, 2 planned | – | Fast") != std::string::npos);
  CHECK(page.markdown.find(
            "| our TD3, MBS, random target | – | 1\u202f900 | 500 | – | – | – | – | – | – | 80 % | – | 0 | "
            "1 of 1, 1 planned |") != std::string::npos);
}

TEST_CASE("times alone are the steps at the pace that was measured alone") {
  Kept made, alone;
  made.add_training("policy/best/centre/1", tests::kRisen);
  made.add_training("policy/paper/centre/1", tests::kRising);
  alone.add_training("pace/best/centre", {0.0, 1.0, 2.0, 3.0, 4.0});
  runs::CellRecord& record = alone.kept.records["pace/best/centre"];
  record.machine["git_commit"] = "def";
  record.curve->seconds = {0.0, 50.0, 60.0, 61.0, 62.0};  // warms up until the second evaluation
  record.curve->processor_seconds = {0.0, 49.0, 59.0, 59.9, 60.8};
  record.policy->train_seconds = 62.0;
  record.policy->other_processor_seconds = 3.1;
  record.policy->products = "float32";
  SECTION("measured") {
    report::PaperPage page(made.kept, alone.kept);
    report::add_training(page);
    CHECK(page.markdown.find(
              "| our TD3, MBS, centre | – | 1\u202f900 | 500 | 100 | 33 | 63 | 50 | 77 | 190 |") !=
          std::string::npos);  // after 200 steps in a minute 100 in a second
    CHECK(
        page.markdown.find("| as the paper's, MBS, centre | 1.5 h | 1\u202f900 | had not converged | – |") !=
        std::string::npos);
    CHECK(page.markdown.find("Fast; float32; commits def), of which each had at least 90 % of a processor; "
                             "others kept at most 0.05 busy.") != std::string::npos);
    CHECK(page.markdown.find("Commits: abc, def.") != std::string::npos);
  }
  SECTION("broken off too early") {
    alone.kept.records["pace/best/centre"].curve->env_steps.resize(1);
    report::PaperPage page(made.kept, alone.kept);
    report::add_training(page);
    CHECK(page.markdown.find("Alone: not measured yet") != std::string::npos);
  }
}
