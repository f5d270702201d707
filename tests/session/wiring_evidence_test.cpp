#include "lodestone/session/wiring_evidence.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstddef>
#include <vector>

#include "lodestone/common/random.h"

using namespace lodestone;
using session::CoilWiring;
using session::PossibleWirings;
using session::WiringEvidence;

namespace {

/// All of them, one by one.
std::vector<CoilWiring> every_wiring(std::size_t coils) {
  std::vector<CoilWiring> all;
  CoilWiring wiring(coils);
  do {
    for (unsigned signs = 0; signs < 1U << coils; ++signs) {
      for (std::size_t i = 0; i < coils; ++i) wiring.sign[i] = (signs >> i & 1U) != 0 ? -1 : 1;
      all.push_back(wiring);
    }
  } while (std::next_permutation(wiring.coil.begin(), wiring.coil.end()));
  return all;
}

using Costs = std::vector<std::vector<std::array<double, 2>>>;

double against(const Costs& costs, const CoilWiring& wiring) {
  double sum = 0.0;
  for (std::size_t i = 0; i < costs.size(); ++i)
    sum += costs[i][static_cast<std::size_t>(wiring.coil[i])][wiring.sign[i] > 0 ? 0 : 1];
  return sum;
}

/// Each coil as it should be, and much against everything else.
WiringEvidence all_known(std::size_t coils) {
  WiringEvidence evidence(coils);
  for (std::size_t asked = 0; asked < coils; ++asked)
    for (std::size_t coil = 0; coil < coils; ++coil)
      for (const bool reversed : {false, true})
        if (coil != asked || reversed) evidence.add(asked, coil, reversed, 10.0);
  return evidence;
}

}  // namespace

TEST_CASE("what is possible is what looking at every wiring finds") {
  for (const std::size_t coils : {1U, 2U, 4U, 5U}) {
    common::RandomStream random(7 + coils, "wiring evidence");
    Costs costs(coils, std::vector<std::array<double, 2>>(coils));
    WiringEvidence evidence(coils);
    for (std::size_t asked = 0; asked < coils; ++asked)
      for (std::size_t coil = 0; coil < coils; ++coil)
        for (const bool reversed : {false, true}) {
          costs[asked][coil][reversed ? 1 : 0] = random.uniform(0.0, 5.0);
          evidence.add(asked, coil, reversed, costs[asked][coil][reversed ? 1 : 0]);
        }
    const std::vector<CoilWiring> all = every_wiring(coils);
    double least = against(costs, all.front());
    for (const CoilWiring& wiring : all) least = std::min(least, against(costs, wiring));
    CHECK(evidence.least() == least);
    const PossibleWirings possible = evidence.possible(1.5);
    std::size_t count = 0;
    for (const CoilWiring& wiring : all) {
      const bool is = against(costs, wiring) < least + 1.5;
      count += is ? 1U : 0U;
      CHECK(is ==
            (std::find(possible.listed.begin(), possible.listed.end(), wiring) != possible.listed.end()));
    }
    CAPTURE(coils, count);
    CHECK(possible.listed.size() == count);
    CHECK(possible.open() == count);
  }
}

TEST_CASE("nothing is known of sixteen coils at first, and everything in the end") {
  constexpr std::size_t kCoils = 16;
  const PossibleWirings anything = WiringEvidence(kCoils).possible(7.0);
  CHECK(anything.listed.size() == PossibleWirings::kMostListed);
  REQUIRE(anything.answers.size() == kCoils);
  for (const auto& of_one : anything.answers) CHECK(of_one.size() == 2 * kCoils);
  const PossibleWirings one = all_known(kCoils).possible(7.0);
  CHECK(one.listed == std::vector<CoilWiring>{CoilWiring(kCoils)});
  CHECK(one.open() == 1);
  CHECK(one.open() < anything.open());
}

TEST_CASE("a coil that is known is known, although the others have more wirings than anybody lists") {
  constexpr std::size_t kCoils = 8;
  WiringEvidence evidence(kCoils);
  for (std::size_t coil = 0; coil < kCoils; ++coil)
    for (const bool reversed : {false, true})
      if (coil != 5 || !reversed) evidence.add(2, coil, reversed, 10.0);
  const PossibleWirings possible = evidence.possible(7.0);
  CHECK(possible.listed.size() == PossibleWirings::kMostListed);
  REQUIRE(possible.answers[2].size() == 1);
  CHECK(possible.answers[2].front().coil == 5);
  CHECK(possible.answers[2].front().sign == -1);
  CHECK(possible.answers[0].size() == 2 * (kCoils - 1));  // any but the one that is taken
  CHECK(possible.open() < WiringEvidence(kCoils).possible(7.0).open());
}
