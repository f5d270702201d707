#include "bounds.h"

#include <algorithm>
#include <cstdio>

#include "lodestone/common/error.h"

namespace lodestone::apps {

void print_bounds(const std::vector<experiments::BoundedFigure>& figures, std::size_t first) {
  for (std::size_t i = first; i < figures.size(); ++i) {
    const experiments::BoundedFigure& one = figures[i];
    std::printf("%-52s %9.3f %-3s bound %.3f  %s\n", one.figure.c_str(), one.value, one.unit.c_str(),
                one.bound, one.ok ? "ok" : "BROKEN");
  }
  std::fflush(stdout);
}

void check_bounds(const std::string& verb, const std::vector<experiments::BoundedFigure>& figures) {
  const auto broken = [](const experiments::BoundedFigure& one) { return !one.ok; };
  const auto first = std::find_if(figures.begin(), figures.end(), broken);
  if (first == figures.end()) return;
  throw common::HardwareError(verb + ": " + std::to_string(std::count_if(first, figures.end(), broken)) +
                              " bounds are broken, the first: " + first->figure);
}

}  // namespace lodestone::apps
