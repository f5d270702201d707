#include "lodestone/inference/convolution.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using namespace lodestone;
using inference::FeatureMap;

namespace {

std::vector<float> drawn(std::size_t count, const char* name) {
  common::RandomStream random(1, name);
  std::vector<float> numbers(count);
  for (float& number : numbers) number = static_cast<float>(random.uniform(-1.0, 1.0));
  return numbers;
}

FeatureMap drawn_map(std::int64_t height, std::int64_t width, std::int64_t channels) {
  FeatureMap map;
  const std::vector<float> numbers = drawn(static_cast<std::size_t>(height * width * channels), "map");
  std::copy(numbers.begin(), numbers.end(), map.resize(height, width, channels));
  return map;
}

double at(const FeatureMap& map, std::int64_t y, std::int64_t x, std::int64_t c) {
  const bool inside = y >= 0 && y < map.height() && x >= 0 && x < map.width();
  return inside ? map.row(y)[x * map.channels() + c] : 0.0;
}

/// The definition: largest difference of `out` from it.
double worst_difference(const FeatureMap& in, const std::vector<float>& weight,
                        const std::vector<float>& bias, std::int64_t side, inference::Stride stride,
                        bool relu, const FeatureMap& out) {
  double worst = 0.0;
  for (std::int64_t y = 0; y < out.height(); ++y)
    for (std::int64_t x = 0; x < out.width(); ++x)
      for (std::int64_t o = 0; o < out.channels(); ++o) {
        double sum = bias[static_cast<std::size_t>(o)];
        auto w = weight.begin() + o * in.channels() * side * side;
        for (std::int64_t c = 0; c < in.channels(); ++c)
          for (std::int64_t dy = 0; dy < side; ++dy)
            for (std::int64_t dx = 0; dx < side; ++dx)
              sum += *w++ *
                     at(in, y * stride.step - stride.border + dy, x * stride.step - stride.border + dx, c);
        worst = std::max(worst, std::abs((relu ? std::max(sum, 0.0) : sum) - at(out, y, x, o)));
      }
  return worst;
}

}  // namespace

TEST_CASE("a convolution is what its definition says, for every kernel, stride and border here", "[unit]") {
  inference::CacheAligned<float> lines;
  for (const auto& [side, stride] : {std::pair<std::int64_t, inference::Stride>{3, {1, 1}},
                                     {1, {1, 0}},
                                     {6, {4, 1}},
                                     {1, {1, 0}},
                                     {18, {16, 1}}})
    for (const bool relu : {false, true}) {
      const std::int64_t channels = 5, outputs = 7;
      const std::vector<float> weight =
          drawn(static_cast<std::size_t>(outputs * channels * side * side), "weight");
      const std::vector<float> bias = drawn(static_cast<std::size_t>(outputs), "bias");
      const FeatureMap in = drawn_map(32, 48, channels);
      FeatureMap out;
      inference::Convolution(weight, bias, side, stride, relu).run(in, out, lines);
      CAPTURE(side, stride.step, relu);
      CHECK(out.height() == 32 / stride.step);
      CHECK(out.width() == 48 / stride.step);
      CHECK(out.channels() == outputs);
      CHECK(worst_difference(in, weight, bias, side, stride, relu, out) < 1e-4);
    }
}

TEST_CASE("maps are halved to the largest of four, and doubled beside those from across", "[unit]") {
  FeatureMap small = drawn_map(4, 6, 3);
  FeatureMap halved;
  inference::halve(small, halved);
  CHECK(halved.height() == 2);
  CHECK(halved.width() == 3);
  for (std::int64_t c = 0; c < 3; ++c)
    CHECK(at(halved, 1, 2, c) ==
          std::max({at(small, 2, 4, c), at(small, 2, 5, c), at(small, 3, 4, c), at(small, 3, 5, c)}));
  const FeatureMap across = drawn_map(8, 12, 2);
  FeatureMap joined;
  inference::double_beside(across, small, joined);
  REQUIRE(joined.channels() == 5);
  for (const auto& [y, x] : {std::pair<std::int64_t, std::int64_t>{0, 0}, {5, 7}, {7, 11}}) {
    for (std::int64_t c = 0; c < 2; ++c) CHECK(at(joined, y, x, c) == at(across, y, x, c));
    for (std::int64_t c = 0; c < 3; ++c) CHECK(at(joined, y, x, 2 + c) == at(small, y / 2, x / 2, c));
  }
  CHECK_THROWS_AS(inference::double_beside(small, small, joined), common::LogicFault);
}

TEST_CASE("weights that are no square kernels, and images of other channels, are refused", "[unit]") {
  CHECK_THROWS_AS(inference::Convolution(std::vector<float>(10), {0.0F}, 3, {}, true), common::LogicFault);
  const inference::Convolution convolution(std::vector<float>(18), {0.0F}, 3, {1, 1}, true);
  FeatureMap out;
  inference::CacheAligned<float> lines;
  CHECK_THROWS_AS(convolution.run(drawn_map(4, 4, 3), out, lines), common::LogicFault);
}
