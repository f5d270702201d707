#include "lodestone/inference/gemm.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using namespace lodestone::inference;

namespace {

/// Uses each of the processor's kernels in turn, and the widest again at the end.
struct EveryKernel {
  ~EveryKernel() { select_gemm_kernels(gemm_kernels().front()); }
};

template <class Real>
struct Matrix {
  Matrix(std::int64_t m, std::int64_t n, Real value = 0)
      : rows(m), columns(n), numbers(static_cast<std::size_t>(m * n), value) {}
  Real& at(std::int64_t row, std::int64_t column) {
    return numbers[static_cast<std::size_t>(row * columns + column)];
  }
  Real at(std::int64_t row, std::int64_t column) const {
    return numbers[static_cast<std::size_t>(row * columns + column)];
  }
  Matrix transposed() const {
    Matrix turned(columns, rows);
    for (std::int64_t r = 0; r < rows; ++r)
      for (std::int64_t c = 0; c < columns; ++c) turned.at(c, r) = at(r, c);
    return turned;
  }
  Matrix some_rows(std::int64_t first, std::int64_t count) const {
    Matrix part(count, columns);
    std::copy_n(numbers.begin() + first * columns, count * columns, part.numbers.begin());
    return part;
  }

  std::int64_t rows, columns;
  std::vector<Real> numbers;
};

template <class Real>
Matrix<Real> random_matrix(std::int64_t rows, std::int64_t columns, lodestone::common::RandomStream& random) {
  Matrix<Real> matrix(rows, columns);
  for (Real& number : matrix.numbers) number = static_cast<Real>(random.normal());
  return matrix;
}

template <class Real>
Matrix<Real> product(const Matrix<Real>& a, const PackedMatrix<Real>& b,
                     const Epilogue<Real>& epilogue = {}) {
  Matrix<Real> out(a.rows, b.n(), Real(777));
  multiply<Real>({a.numbers.data(), a.rows, a.columns}, b, out.numbers.data(), epilogue);
  return out;
}

/// Largest difference from the product in long double, after `then` (element, row, column).
template <class Real, class Then>
double error_of(const Matrix<Real>& result, const Matrix<Real>& a, const Matrix<Real>& b, Then then) {
  long double most = 0.0L;
  for (std::int64_t r = 0; r < a.rows; ++r) {
    for (std::int64_t c = 0; c < b.columns; ++c) {
      long double sum = 0.0L;
      for (std::int64_t i = 0; i < a.columns; ++i) sum += static_cast<long double>(a.at(r, i)) * b.at(i, c);
      most = std::max(most, std::abs(then(sum, r, c) - static_cast<long double>(result.at(r, c))));
    }
  }
  return static_cast<double>(most);
}

template <class Real>
void check_products(std::int64_t m, std::int64_t k, std::int64_t n, double tolerance,
                    lodestone::common::RandomStream& random) {
  INFO(m << " x " << k << " times " << k << " x " << n);
  const auto a = random_matrix<Real>(m, k, random);
  const auto b = random_matrix<Real>(k, n, random);
  const auto bias = random_matrix<Real>(1, n, random);
  const auto mask = random_matrix<Real>(m, n, random);
  const double allowed = 4.0 * tolerance * static_cast<double>(k);
  const RightSide<Real> plain{b.numbers.data(), k, n};
  const PackedMatrix<Real> packed(plain);
  using Wide = long double;
  CHECK(error_of(product(a, packed), a, b, [](Wide x, auto, auto) { return x; }) <= allowed);
  CHECK(error_of(product<Real>(a, packed, {bias.numbers.data(), true, nullptr}), a, b,
                 [&](Wide x, auto, std::int64_t c) { return std::max(x + bias.at(0, c), 0.0L); }) <= allowed);
  CHECK(error_of(product<Real>(a, packed, {nullptr, false, mask.numbers.data()}), a, b,
                 [&](Wide x, std::int64_t r, std::int64_t c) { return mask.at(r, c) > 0 ? x : 0.0L; }) <=
        allowed);
  const Matrix<Real> transposed = b.transposed();
  const RightSide<Real> turned{transposed.numbers.data(), k, n, true};
  CHECK(product(a, PackedMatrix<Real>(turned)).numbers == product(a, packed).numbers);
  CacheAligned<Real> scratch;
  for (const RightSide<Real>& right : {plain, turned}) {
    Matrix<Real> out(m, n, Real(777));
    multiply<Real>({a.numbers.data(), m, k}, right, scratch, out.numbers.data());
    CHECK(out.numbers == product(a, packed).numbers);
  }
}

}  // namespace

TEST_CASE("Products of every kernel are right, whatever is left over at the edges", "[inference]") {
  const EveryKernel restore;
  lodestone::common::RandomStream random(1, "gemm");
  for (const std::string& kernel : gemm_kernels()) {
    INFO(kernel);
    select_gemm_kernels(kernel);
    CHECK(gemm_kernel_name() == kernel);
    for (const std::int64_t m : {1, 5, 12, 13, 64}) {
      for (const std::int64_t k : {1, 7, 33, 100}) {
        for (const std::int64_t n : {1, 2, 15, 16, 17, 32, 45, 80}) {
          check_products<float>(m, k, n, 1e-6, random);
          check_products<double>(m, k, n, 1e-14, random);
        }
      }
    }
  }
}

TEST_CASE("A row's product does not depend on the rows around it", "[inference]") {
  const EveryKernel restore;
  lodestone::common::RandomStream random(2, "gemm");
  const auto a = random_matrix<float>(50, 37, random);
  const auto b = random_matrix<float>(37, 40, random);
  for (const std::string& kernel : gemm_kernels()) {
    INFO(kernel);
    select_gemm_kernels(kernel);
    const PackedMatrix<float> packed({b.numbers.data(), 37, 40});
    const Matrix<float> whole = product(a, packed);
    for (const std::int64_t rows : {1, 11, 12, 30}) {
      CHECK(product(a.some_rows(3, rows), packed).numbers == whole.some_rows(3, rows).numbers);
    }
  }
}

TEST_CASE("The kernels for AVX2 and AVX-512 agree to the last bit", "[inference]") {
  const EveryKernel restore;
  lodestone::common::RandomStream random(3, "gemm");
  const auto a = random_matrix<float>(50, 300, random);
  const auto b = random_matrix<float>(300, 70, random);
  std::vector<std::vector<float>> results;
  for (const std::string& kernel : gemm_kernels()) {
    if (kernel == "generic")
      continue;  // multiplies and adds in two roundings where there is no instruction for both
    select_gemm_kernels(kernel);
    results.push_back(product(a, PackedMatrix<float>({b.numbers.data(), 300, 70})).numbers);
  }
  for (const std::vector<float>& result : results) CHECK(result == results.front());
}

TEST_CASE("A transpose with padded rows is the transpose", "[inference]") {
  const EveryKernel restore;
  lodestone::common::RandomStream random(4, "gemm");
  for (const std::string& kernel : gemm_kernels()) {
    INFO(kernel);
    select_gemm_kernels(kernel);
    for (const auto& [rows, columns] :
         {std::pair(1, 1), std::pair(16, 16), std::pair(40, 23), std::pair(7, 65)}) {
      const auto matrix = random_matrix<float>(rows, columns, random);
      const std::int64_t stride = padded_stride(rows);
      Matrix<float> out(columns, stride);
      transpose(matrix.numbers.data(), rows, columns, out.numbers.data(), stride);
      Matrix<float> expected(columns, stride);
      for (std::int64_t r = 0; r < rows; ++r)
        for (std::int64_t c = 0; c < columns; ++c) expected.at(c, r) = matrix.at(r, c);
      CHECK(out.numbers == expected.numbers);
    }
  }
}

TEST_CASE("What is not a number stays visible through a ReLU", "[inference]") {
  const EveryKernel restore;
  for (const std::string& kernel : gemm_kernels()) {
    select_gemm_kernels(kernel);
    const Matrix<float> a(14, 20, std::numeric_limits<float>::quiet_NaN());
    const Matrix<float> b(20, 40, 1.0F);
    const PackedMatrix<float> packed({b.numbers.data(), 20, 40});
    for (const float x : product<float>(a, packed, {nullptr, true, nullptr}).numbers) CHECK(std::isnan(x));
  }
  CHECK_THROWS_AS(select_gemm_kernels("abacus"), lodestone::common::LogicFault);
}
