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
  CHECK(page.markdown.find("| our TD3, MBS, centre | – | 1\u202f900 | 500 | 50 | 45 |") != std::string::npos);
  CHECK(page.markdown.find("| our TD3, MBS, random target | – | not run yet |") != std::string::npos);
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
            "| our TD3, MBS, centre | – | 1\u202f900 | 500 | 50 | 45 | 190 | 171 | 11 | 80 % | – | 1 | "
            "2 of 2, 2 planned | – | Fast") != std::string::npos);
  CHECK(page.markdown.find(
            "| our TD3, MBS, random target | – | 1\u202f900 | 500 | – | – | – | – | – | 80 % | – | 0 | "
            "1 of 1, 1 planned |") != std::string::npos);
}
