#include "lodestone/inference/gemm_bf16.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using namespace lodestone;
using namespace lodestone::inference;

namespace {

using Numbers = std::vector<float>;

/// Uses each of the processor's kernels in turn, and the first again at the end.
struct EveryBf16Kernel {
  ~EveryBf16Kernel() { select_bf16_kernel(bf16_kernels().front()); }
  template <class Check>
  void operator()(const Check& check) const {
    for (const std::string& name : bf16_kernels()) {
      INFO("kernel " << name);
      select_bf16_kernel(name);
      check();
    }
  }
};

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
  EveryBf16Kernel{}([] {
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
          for (std::int64_t column = 0; column < n; ++column) {
            const double element = out[static_cast<std::size_t>(row * n + column)];
            worst = std::max(worst, std::abs(element - p.exact(row, column)));
          }
        CAPTURE(m, n, k, transposed);
        CHECK(worst < 2e-5 * static_cast<double>(k));  // float32 sums
      }
  });
}

TEST_CASE("operands are rounded to the nearest, ties to even, and subnormal ones are zero") {
  constexpr std::int64_t kSide = 33;  // odd: the last of k has no other beside it
  const float step = std::ldexp(1.0F, -7);
  const float subnormal = std::ldexp(1.0F, -130);
  Product p{4, kSide, kSide, kSide, Numbers(4 * kSide), Numbers(kSide * kSide), false};
  for (std::int64_t i = 0; i < kSide; ++i) p.b[static_cast<std::size_t>(i * kSide + i)] = 1.0F;
  const Numbers operands{
      1.0F + 0.5F * step, 1.0F + 1.5F * step, 1.0F + 0.51F * step,    -1.0F - 0.5F * step,
      subnormal,          -subnormal,         std::ldexp(1.0F, -126), std::ldexp(1.0F, 127)};
  const Numbers rounded_so{1.0F, 1.0F + 2.0F * step,     1.0F + step,          -1.0F, 0.0F,
                           0.0F, std::ldexp(1.0F, -126), std::ldexp(1.0F, 127)};
  std::copy(operands.begin(), operands.end(), p.a.begin());
  std::copy(operands.rbegin(), operands.rend(), p.a.end() - 8);
  EveryBf16Kernel{}([&] {
    const Numbers out = p.out();
    CHECK(std::equal(rounded_so.begin(), rounded_so.end(), out.begin()));
    CHECK(std::equal(rounded_so.rbegin(), rounded_so.rend(), out.end() - 8));
  });
}

TEST_CASE("sums below the normal range are zero where instructions for these products make them") {
  constexpr std::int64_t kSide = 32;
  const float small = std::ldexp(1.0F, -68);  // 32 products: 2^-131
  const Product p{1, kSide, kSide, kSide, Numbers(kSide, small), Numbers(kSide * kSide, small), false};
  const EveryBf16Kernel first_again;
  for (const std::string& name : bf16_kernels()) {
    if (name == "rounded") continue;  // as the thread's mode has it
    INFO("kernel " << name);
    select_bf16_kernel(name);
    CHECK(p.out().back() == 0.0F);
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
  const Product p = product(77, 64, 97, true);
  EveryBf16Kernel{}([&] {
    const Numbers all = p.out();
    for (const std::int64_t rows : {1, 11, 12, 13, 31, 32, 33, 76}) {
      const Numbers some = p.out({}, rows);
      CHECK(std::memcmp(some.data(), all.data(), some.size() * sizeof(float)) == 0);
    }
  });
}

TEST_CASE("bias, ReLU and mask come after the product, and NaN stays") {
  EveryBf16Kernel{}([] {
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
  });
}

TEST_CASE("a kernel that this processor lacks is refused") {
  CHECK_THROWS_AS(select_bf16_kernel("abacus"), common::LogicFault);
  CHECK(bf16_kernels().back() == "rounded");
}

TEST_CASE("how much faster it is here is measured once") {
  const double speedup = bf16_speedup();
  CHECK(speedup > 0.0);
  CHECK(speedup == bf16_speedup());
}
