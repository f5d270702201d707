#include <catch2/catch.hpp>

#include "../../src/report/paper_page.h"
#include "report/kept_paper.h"

using namespace lodestone;
using tests::Kept;

TEST_CASE("what the paper leaves open stands as it was chosen and otherwise") {
  Kept made;
  made.add_training("policy/paper/centre/1", tests::kRisen);
  made.add_training("open/reward_in_mm/policy/1", tests::kRising);
  report::PaperPage page(made.kept);
  report::add_open_choices(page);
  CHECK(page.markdown.find("| dish radii (ours) | 10.00 | 0.0 to 10.0 | – | 80 %") != std::string::npos);
  CHECK(page.markdown.find("| mm | 19.00 | 0.0 to 19.0 | – | 80 %") != std::string::npos);
  CHECK(page.markdown.find("| m | not run yet |") != std::string::npos);
}

TEST_CASE("ablations of few trials say that no sentence can be built on them") {
  Kept made;
  for (const char* task : {"point", "square"})
    made.add_trials(std::string("ablation/without_memory/") + task + "/1", 1, {4.0, 5.0});
  made.add("ablation/with_memory/point/1", false);
  report::PaperPage page(made.kept);
  report::add_ablations(page);
  CHECK(page.markdown.find("| with memory | not run yet |") != std::string::npos);
  CHECK(page.markdown.find("1 of these rows have fewer than 200 trials or 5 seeds") != std::string::npos);
  CHECK(page.markdown.find("| without memory | 4.50") != std::string::npos);
}
