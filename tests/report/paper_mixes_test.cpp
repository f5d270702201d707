#include <catch2/catch.hpp>

#include "../../src/report/paper_page.h"
#include "report/kept_paper.h"

using namespace lodestone;
using tests::Kept;

namespace {

std::string mixes(int seeds, int fallen = 0) {
  Kept made;
  const std::vector<double> low(20, -4.0);
  std::vector<double> collapsed = tests::kRisen;
  for (std::size_t i = 12; i < collapsed.size(); ++i) collapsed[i] = -4.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::vector<double> lower = tests::kRisen, alike = tests::kRisen;
    for (double& value : lower) value -= 2.0 + 0.1 * seed;
    alike.back() += seed % 2 == 0 ? 0.5 : -0.5;
    const std::string name = "/" + std::to_string(seed);
    made.add_training("mix/0" + name, tests::kRisen);
    made.add_training("mix/1" + name, alike);
    made.add_training("mix/2" + name, lower);
    made.add_training("mix/3" + name, seed <= fallen ? collapsed : low);
  }
  report::PaperPage page(made.kept);
  report::add_mixes(page);
  return page.markdown;
}

}  // namespace

TEST_CASE("mixes are compared by their final return where there are five seeds of each") {
  const std::string text = mixes(5);
  CHECK(text.find("1 of 3 replay: the final return is not told apart") != std::string::npos);
  CHECK(text.find("2 of 3 replay: the final return is lower (-2.30, ") != std::string::npos);
  CHECK(text.find("3 of 3 replay: the final return is lower (-14.00, -14.00 to -14.00)") !=
        std::string::npos);
  CHECK(text.find("nothing is said") == std::string::npos);
  CHECK(text.find("its maximum comes after 500 steps instead of 500") != std::string::npos);
}

TEST_CASE("seeds that collapse are counted, and the others are told apart from the paper's") {
  const auto tells = [](int fallen, const char* what) {
    return mixes(5, fallen).find(what) != std::string::npos;
  };
  CHECK(tells(
      0, "Nothing but recorded steps fell back in 0 of 5 seeds; in the paper it collapses. Our reading"));
  CHECK(tells(
      1, "Nothing but recorded steps fell back in 1 of 5 seeds; in the paper it collapses. Our reading"));
  CHECK(tells(5, "Nothing but recorded steps fell back in 5 of 5 seeds"));
  CHECK_FALSE(tells(5, "Our reading"));
}

TEST_CASE("fewer seeds support no sentence") {
  const std::string text = mixes(4);
  CHECK(text.find("fewer than 5 training seeds") != std::string::npos);
  CHECK(text.find("replay: the final return") == std::string::npos);
  CHECK(text.find("fell back in") == std::string::npos);
  CHECK(text.find("| 3 of 3, nothing but recorded steps | -4.00 | -14.00 (-14.00 to -14.00, 4 seeds) | 0.000 "
                  "| had not converged |") != std::string::npos);
}
