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
  CHECK(page.markdown.find("| as the paper's, MBS, centre | 1.5 h | 1900 | had not converged | – |") !=
        std::string::npos);
  CHECK(page.markdown.find("| our TD3, MBS, centre | – | 1900 | 80 | 72 |") != std::string::npos);
  CHECK(page.markdown.find("| our TD3, MBS, random target | – | not run yet |") != std::string::npos);
}
