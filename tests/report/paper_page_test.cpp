#include "../../src/report/paper_page.h"

#include <catch2/catch.hpp>

#include "report/kept_paper.h"

using namespace lodestone;
using tests::Kept;

TEST_CASE("a table is the same as HTML and as Markdown, and says what is missing") {
  report::PaperTable table{{"controller", "around it", "error"}};
  table.cells.push_back({"a < b", "bare", "1.0"});
  table.add_missing({"c", "bare"});
  CHECK(table.markdown() ==
        "| controller | around it | error |\n| --- | --- | --- |\n| a < b | bare | 1.0 |\n| c | bare | not "
        "run yet |\n");
  CHECK(table.html().find("a &lt; b") != std::string::npos);
  CHECK(table.html().find("not run yet") != std::string::npos);
}

TEST_CASE("a task is done by the policy for it, or by the one for any target") {
  Kept made;
  made.add_training("policy/paper/centre/1", tests::kRisen);
  made.add_training("policy/paper/target/1", tests::kRising);
  made.add_training("policy/any_rig/target/1", tests::kRising);
  const report::PaperPage page(made.kept);
  const report::SeedRecords& driven = *page.by_id.at("policy/paper/target");
  CHECK(page.training_of("paper", "centre", driven)->n_converged == 1);
  CHECK(page.training_of("paper", "square", driven)->n_converged == 0);
  CHECK(page.training_of("any_rig", "centre", driven));
  CHECK_FALSE(page.training_of("planner", "centre", driven));
  CHECK_FALSE(page.training_of("paper", "centre", {}));
  CHECK(page.errors("paper", "bare", "centre") == nullptr);
  CHECK(page.return_chart("fig", "Return", {{"paper", "policy/paper/centre"}}).find("Return") !=
        std::string::npos);
}
