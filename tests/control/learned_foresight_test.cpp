#include "lodestone/control/learned_foresight.h"

#include <catch2/catch.hpp>
#include <vector>

#include "env/linear_model.h"

using namespace lodestone;

namespace {

constexpr double kMemberGain_m = 0.8e-3;

std::shared_ptr<const control::LearnedSimulator> known(const std::vector<double>& gain_m) {
  return std::make_shared<const control::LearnedSimulator>(
      env::tests::linear_model(data::StateLayout::kPose, gain_m, std::vector<double>(gain_m.size(), 0.1)));
}

}  // namespace

TEST_CASE("each member of an ensemble is a way that a pulse may go, at any time the same") {
  control::LearnedForesight foresight(known({kMemberGain_m, 2.0 * kMemberGain_m}));
  CHECK(foresight.facts().ways == 2);
  CHECK(foresight.facts().state_size == 3);
  CHECK(foresight.facts().action.size == 2);
  CHECK(foresight.facts().dish_radius_m == Approx(0.0425));
  CHECK_FALSE(foresight.facts().by_chance);
  const std::vector<double> state = {0.001, 0.002, 0.3, -0.004, 0.0, 0.0};
  const std::vector<double> drive = {1.0, 0.0, 0.0, -2.0};
  common::RandomStream random(1, "luck");
  std::vector<double> next(6);
  for (const std::size_t periods : {0, 5}) {
    for (const std::size_t way : {0, 1}) {
      CAPTURE(periods, way);
      const double gain_m = way == 0 ? kMemberGain_m : 2.0 * kMemberGain_m;
      foresight.foresee(way, periods, state.data(), drive.data(), 2, random, next.data());
      CHECK(next[0] == Approx(0.001 + gain_m).margin(1e-8));
      CHECK(next[1] == Approx(0.002).margin(1e-8));
      CHECK(next[2] == Approx(0.4).margin(1e-6));
      CHECK(next[3] == Approx(-0.004).margin(1e-8));
      CHECK(next[4] == Approx(-2.0 * gain_m).margin(1e-8));
    }
  }
}

TEST_CASE("where outcomes are drawn, the rows of a particle have the same luck, and the next has another") {
  const auto model =
      std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(kMemberGain_m));
  control::LearnedForesight foresight(model);
  CHECK(foresight.facts().by_chance);
  const std::vector<double> state(6), drive = {1.0, 0.5, 1.0, 0.5};
  common::RandomStream random(1, "luck"), again(1, "luck");
  std::vector<double> first(6), second(6), copied(6);
  foresight.foresee(0, 0, state.data(), drive.data(), 2, random, first.data());
  foresight.foresee(0, 0, state.data(), drive.data(), 2, random, second.data());
  for (std::size_t i = 0; i < 3; ++i) CHECK(first[i] == first[i + 3]);
  CHECK(first[0] != second[0]);
  foresight.clone()->foresee(0, 0, state.data(), drive.data(), 2, again, copied.data());
  CHECK(copied == first);
}
