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
