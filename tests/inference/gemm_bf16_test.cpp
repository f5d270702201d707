#include "lodestone/inference/gemm_bf16.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>
#include <vector>

#include "lodestone/common/random.h"

using namespace lodestone;
using namespace lodestone::inference;

namespace {

using Numbers = std::vector<float>;

Numbers drawn(std::int64_t count, common::RandomStream& random) {
  Numbers numbers(static_cast<std::size_t>(count));
  for (float& number : numbers) number = static_cast<float>(random.normal());
  return numbers;
}

/// By its definition: the nearest number with 8 bits of mantissa, ties to even.
double rounded(float value) {
  if (value == 0.0F) return 0.0;
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(mantissa, 8)), exponent - 8);
}

struct Product {
  std::int64_t m, n, k, stride;
  Numbers a, b;
  bool transposed;

  Numbers out(const Epilogue<float>& epilogue = {}, std::int64_t rows = -1) const {
    Numbers result(static_cast<std::size_t>((rows < 0 ? m : rows) * n), 777.0F);
    Bf16Scratch scratch;
    multiply_bf16({a.data(), rows < 0 ? m : rows, stride}, {b.data(), k, n, transposed}, scratch,
                  result.data(), epilogue);
    return result;
  }
  double exact(std::int64_t row, std::int64_t column) const {
    double sum = 0.0;
    for (std::int64_t i = 0; i < k; ++i)
      sum += rounded(a[static_cast<std::size_t>(row * stride + i)]) *
             rounded(b[static_cast<std::size_t>(transposed ? column * k + i : i * n + column)]);
    return sum;
  }
};

Product product(std::int64_t m, std::int64_t n, std::int64_t k, bool transposed) {
  common::RandomStream random(7, "bf16");
  return {m, n, k, k + 3, drawn(m * (k + 3), random), drawn(k * n, random), transposed};
}

}  // namespace

TEST_CASE("products of rounded operands are what their definition says, whatever the sizes") {
  for (const bool transposed : {false, true})
    for (const auto& [m, n, k] : {std::tuple<std::int64_t, std::int64_t, std::int64_t>{1, 32, 32},
                                  {3, 33, 47},
                                  {64, 96, 64},
                                  {50, 100, 129},
                                  {128, 256, 256}}) {
      const Product p = product(m, n, k, transposed);
      const Numbers out = p.out();
      double worst = 0.0;
      for (std::int64_t row = 0; row < m; ++row)
        for (std::int64_t column = 0; column < n; ++column)
          worst =
              std::max(worst, std::abs(static_cast<double>(out[static_cast<std::size_t>(row * n + column)]) -
                                       p.exact(row, column)));
      CAPTURE(m, n, k, transposed, has_bf16_tiles());
      CHECK(worst < 2e-5 * static_cast<double>(k));  // float32 sums
    }
}

TEST_CASE("small sides are computed in float32") {
  const Product p = product(20, 7, 64, true);
  const Numbers out = p.out();
  double exact = 0.0;
  for (std::int64_t i = 0; i < p.k; ++i)
    exact += static_cast<double>(p.a[static_cast<std::size_t>(i)]) *
             static_cast<double>(p.b[static_cast<std::size_t>(i)]);
  CHECK(out.front() == Approx(exact).epsilon(1e-5));
}

TEST_CASE("a row's product does not depend on the rows beside it") {
  const Product p = product(77, 64, 96, true);
  const Numbers all = p.out();
  for (const std::int64_t rows : {1, 31, 32, 33, 76}) {
    const Numbers some = p.out({}, rows);
    CHECK(std::memcmp(some.data(), all.data(), some.size() * sizeof(float)) == 0);
  }
}

TEST_CASE("bias, ReLU and mask come after the product, and NaN stays") {
  Product p = product(40, 48, 64, true);
  common::RandomStream random(9, "bias");
  const Numbers bias = drawn(p.n, random), mask = drawn(p.m * p.n, random);
  const Numbers plain = p.out();
  const Numbers activated = p.out({bias.data(), true, nullptr});
  const Numbers masked = p.out({nullptr, false, mask.data()});
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CHECK(activated[i] == std::max(plain[i] + bias[i % static_cast<std::size_t>(p.n)], 0.0F));
    CHECK(masked[i] == (mask[i] > 0.0F ? plain[i] : 0.0F));
  }
  p.a[0] = std::numeric_limits<float>::quiet_NaN();
  CHECK(std::isnan(p.out({bias.data(), true, nullptr})[0]));
  CHECK_FALSE(std::isnan(p.out()[static_cast<std::size_t>(p.n)]));  // the next row
}

TEST_CASE("how much faster it is here is measured once") {
  const double speedup = bf16_speedup();
  CHECK(speedup > 0.0);
  CHECK(speedup == bf16_speedup());
}
