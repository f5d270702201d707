#include <catch2/catch.hpp>

#include "../../src/report/paper_page.h"
#include "report/kept_paper.h"

using namespace lodestone;
using tests::Kept;

TEST_CASE("rows of the transfer table stand beside the paper's, bare ones only, and beside the bare pull") {
  Kept made;
  made.add_trials("transfer/paper/bare/centre/1", 11, {6.0, 8.0});
  made.add_trials("transfer/paper/decorated/centre/1", 11, {2.0, 4.0});
  made.add_trials("transfer/baseline/bare/centre/1", 11, {3.0, 3.0});
  made.add("transfer/planner/bare/centre/1", false);
  report::PaperPage page(made.kept);
  report::add_transfer(page);
  CHECK(page.markdown.find("| bare | 6.3 ± 2.1 | 7.00 ± 1.41 |") != std::string::npos);
  CHECK(page.markdown.find("| decorated | – | 3.00 ± 1.41 |") != std::string::npos);
  CHECK(page.markdown.find("+4.00") != std::string::npos);
  CHECK(page.markdown.find("| planner in our MBS | bare | not run yet |") != std::string::npos);
  CHECK(page.markdown.find("point, in mm") == std::string::npos);  // nothing of it is planned
  REQUIRE(page.drawings.size() == 3);
  CHECK(page.drawings.front().first == "paper_bare_centre");
}

TEST_CASE("a row tells of the training of what drove, and of how many trials its difference is") {
  Kept made;
  made.add_trials("transfer/best/bare/point/1", 11, {6.0, 8.0});
  made.add_trials("transfer/best/bare/point/2", 12, {6.0, 8.0});
  made.add_trials("transfer/baseline/bare/point/1", 11, {3.0, 3.0});
  made.add_training("policy/best/target/1", tests::kRisen);
  made.add_training("policy/best/target/2", tests::kRisen);
  made.add_training("policy/best/target/3", tests::kRisen);  // has not driven yet
  made.kept.records["policy/best/target/2"].machine["git_commit"] = "def";
  report::PaperPage page(made.kept);
  report::add_transfer(page);
  CHECK(page.markdown.find("+4.00 (+3.00 to +5.00) on 2 |") != std::string::npos);
  CHECK(page.markdown.find("| 4 | 2 of 2 | 1\u202f900 | – |") != std::string::npos);
  CHECK(page.markdown.find("Commits: abc, def.") != std::string::npos);
}

TEST_CASE(
    "a training's seconds are those that it takes alone, and one policy's are the same for every task") {
  Kept made, alone;
  made.add_trials("transfer/any_rig/bare/centre/1", 11, {1.0});
  made.add_training("policy/any_rig/target/1", tests::kRisen);
  alone.add_training("pace/any_rig/target", {0.0, 1.0, 2.0});
  report::PaperPage page(made.kept, alone.kept);
  report::add_transfer(page);
  CHECK(page.markdown.find("| 1 of 1 | 1\u202f900 | 190 |") != std::string::npos);  // 10 steps/s
}

TEST_CASE(
    "what learned in a learned simulator is compared with its like in the plain one, as far as told apart") {
  Kept made;
  made.add_trials("transfer/paper/bare/centre/1", 11, {2.0, 3.0, 1.0});
  made.add_trials("transfer/paper/bare/centre/2", 12, {9.0});  // the other has not driven with this seed
  made.add_trials("transfer/paper_simulator/bare/centre/1", 11, {4.0, 6.0, 2.0});
  made.add_trials("transfer/best/decorated/centre/1", 11, {2.0, 3.0});
  made.add_trials("transfer/simulator/decorated/centre/1", 11, {1.0, 4.0});
  made.kept.records["transfer/simulator/decorated/centre/1"].machine["git_commit"] = "def";
  report::PaperPage page(made.kept);
  report::add_transfer(page);
  CHECK(page.markdown.find(
            "| TD3 as the paper's | bare | centre | -2.00 (-3.00 to -1.00) | learned | -2.00 (") !=
        std::string::npos);
  CHECK(page.markdown.find("| 3 | 1 |") != std::string::npos);
  const std::size_t compared = page.markdown.find("trained in a learned simulator minus in the plain one");
  CHECK(page.markdown.find("Commits: abc, def.", compared) != std::string::npos);
  CHECK(page.markdown.find("2 of its rows have fewer than 5 training seeds") != std::string::npos);
  CHECK(page.markdown.find("| our TD3 | decorated | centre | +0.00 (-1.00 to +1.00) | not told apart |") !=
        std::string::npos);
}
