#include "lodestone/session/wiring_evidence.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "lodestone/common/error.h"
#include "lodestone/physics/per_coil.h"

namespace lodestone::session {

namespace {

/// Sums of the same numbers in another order differ by less.
constexpr double kRounding = 1e-9;

// Sets of coils, a bit for each.
bool holds_coil(std::size_t set, std::size_t coil) { return (set >> coil & 1U) != 0; }
std::size_t with_coil(std::size_t set, std::size_t coil) { return set | std::size_t{1} << coil; }
std::size_t coils_in(std::size_t set) {
  std::size_t count = 0;
  for (; set != 0; set &= set - 1) ++count;
  return count;
}

/// What answers in the wirings of a list, coil by coil, each first as it should be and then reversed.
std::vector<std::vector<CoilAnswer>> answers_in(const std::vector<CoilWiring>& listed, std::size_t coils) {
  std::vector<std::vector<CoilAnswer>> answers(coils);
  for (std::size_t asked = 0; asked < coils; ++asked)
    for (int coil = 0; coil < static_cast<int>(coils); ++coil)
      for (const int sign : {1, -1})
        if (std::any_of(listed.begin(), listed.end(), [&](const CoilWiring& wiring) {
              return wiring.coil[asked] == coil && wiring.sign[asked] == sign;
            }))
          answers[asked].push_back({coil, sign});
  return answers;
}

}  // namespace

CoilWiring::CoilWiring(std::size_t coils) : coil(coils), sign(coils, 1) {
  std::iota(coil.begin(), coil.end(), 0);
}

std::size_t PossibleWirings::open() const {
  if (listed.size() < kMostListed) return listed.size();
  std::size_t sum = kMostListed;
  for (const std::vector<CoilAnswer>& of_one : answers) sum += of_one.size();
  return sum;
}

WiringEvidence::WiringEvidence(std::size_t coils)
    : against_(coils, std::vector<std::array<double, 2>>(coils, std::array<double, 2>{})) {
  LODESTONE_CHECK(coils >= 1 && coils <= physics::kMostCoils, "1 to 16 coils");
}

void WiringEvidence::add(std::size_t asked, std::size_t coil, bool reversed, double against) {
  against_[asked][coil][reversed ? 1 : 0] += against;
}

double WiringEvidence::either_way(std::size_t asked, std::size_t coil) const {
  return std::min(against_[asked][coil][0], against_[asked][coil][1]);
}

WiringEvidence::Sets WiringEvidence::least_before() const {
  Sets sums(std::size_t{1} << coils(), std::numeric_limits<double>::infinity());
  sums[0] = 0.0;
  for (std::size_t set = 0; set + 1 < sums.size(); ++set) {
    const std::size_t asked = coils_in(set);
    for (std::size_t coil = 0; coil < coils(); ++coil) {
      if (holds_coil(set, coil)) continue;
      double& sum = sums[with_coil(set, coil)];
      sum = std::min(sum, sums[set] + either_way(asked, coil));
    }
  }
  return sums;
}

WiringEvidence::Sets WiringEvidence::least_after() const {
  Sets sums(std::size_t{1} << coils(), std::numeric_limits<double>::infinity());
  sums.back() = 0.0;
  for (std::size_t set = sums.size() - 1; set-- > 0;) {
    const std::size_t asked = coils_in(set);
    for (std::size_t coil = 0; coil < coils(); ++coil)
      if (!holds_coil(set, coil))
        sums[set] = std::min(sums[set], either_way(asked, coil) + sums[with_coil(set, coil)]);
  }
  return sums;
}

double WiringEvidence::least() const { return least_before().back(); }

/// Goes on with a wiring of which the first coils are chosen, whatever may still come of it.
void WiringEvidence::list(PossibleWirings& possible, CoilWiring& wiring, std::size_t asked, std::size_t set,
                          double sum, double bound, const Sets& after) const {
  if (possible.listed.size() == PossibleWirings::kMostListed) return;
  if (asked == coils()) {
    if (sum < bound) possible.listed.push_back(wiring);
    return;
  }
  for (std::size_t coil = 0; coil < coils(); ++coil) {
    if (holds_coil(set, coil)) continue;
    for (const std::size_t reversed : {0U, 1U}) {
      const double so_far = sum + against_[asked][coil][reversed];
      if (so_far + after[with_coil(set, coil)] > bound + kRounding) continue;
      wiring.coil[asked] = static_cast<int>(coil);
      wiring.sign[asked] = reversed == 0 ? 1 : -1;
      list(possible, wiring, asked + 1, with_coil(set, coil), so_far, bound, after);
    }
  }
}

PossibleWirings WiringEvidence::possible(double more) const {
  const Sets before = least_before();
  const Sets after = least_after();
  const double bound = before.back() + more;
  PossibleWirings left;
  CoilWiring wiring(coils());
  list(left, wiring, 0, 0, 0.0, bound, after);
  if (left.listed.size() < PossibleWirings::kMostListed) {
    left.answers = answers_in(left.listed, coils());
    return left;
  }
  std::vector<std::vector<double>> least_with(
      coils(), std::vector<double>(coils(), std::numeric_limits<double>::infinity()));  // but for itself
  for (std::size_t set = 0; set + 1 < before.size(); ++set) {
    std::vector<double>& of_asked = least_with[coils_in(set)];
    for (std::size_t coil = 0; coil < coils(); ++coil)
      if (!holds_coil(set, coil))
        of_asked[coil] = std::min(of_asked[coil], before[set] + after[with_coil(set, coil)]);
  }
  left.answers.resize(coils());
  for (std::size_t asked = 0; asked < coils(); ++asked)
    for (std::size_t coil = 0; coil < coils(); ++coil)
      for (const std::size_t reversed : {0U, 1U})
        if (least_with[asked][coil] + against_[asked][coil][reversed] < bound + kRounding)
          left.answers[asked].push_back({static_cast<int>(coil), reversed == 0 ? 1 : -1});
  return left;
}

}  // namespace lodestone::session
