#include "lodestone/nets/gemm.h"

#include <torch/torch.h>

#include <catch2/catch.hpp>
#include <vector>

#include "lodestone/common/error.h"

using lodestone::nets::Epilogue;
using lodestone::nets::gemm_kernels;
using lodestone::nets::PackedMatrix;
using lodestone::nets::padded_stride;
using lodestone::nets::RightSide;
using lodestone::nets::select_gemm_kernels;

namespace {

/// Uses each of the processor's kernels in turn, and the widest again at the end.
struct EveryKernel {
  ~EveryKernel() { select_gemm_kernels(gemm_kernels().front()); }
};

template <class Real>
torch::Tensor random_matrix(std::int64_t rows, std::int64_t columns) {
  return torch::randn({rows, columns}, torch::CppTypeToScalarType<Real>::value);
}

template <class Real>
torch::Tensor product(const torch::Tensor& a, const PackedMatrix<Real>& b,
                      const Epilogue<Real>& epilogue = {}) {
  torch::Tensor out = torch::full({a.size(0), b.n()}, 777.0, a.scalar_type());
  lodestone::nets::multiply<Real>({a.data_ptr<Real>(), a.size(0), a.size(1)}, b, out.data_ptr<Real>(),
                                  epilogue);
  return out;
}

/// Products of m x k and k x n against LibTorch's in double precision.
template <class Real>
void check_products(std::int64_t m, std::int64_t k, std::int64_t n, double tolerance) {
  INFO(m << " x " << k << " times " << k << " x " << n);
  const torch::Tensor a = random_matrix<Real>(m, k);
  const torch::Tensor b = random_matrix<Real>(k, n);
  const torch::Tensor bias = random_matrix<Real>(1, n);
  const torch::Tensor mask = random_matrix<Real>(m, n);
  const torch::Tensor exact = torch::mm(a.to(torch::kFloat64), b.to(torch::kFloat64));
  const auto agrees = [&](const torch::Tensor& result, const torch::Tensor& expected) {
    return torch::allclose(result.to(torch::kFloat64), expected, 0.0, tolerance * static_cast<double>(k));
  };
  const RightSide<Real> plain{b.data_ptr<Real>(), k, n};
  const PackedMatrix<Real> packed(plain);
  CHECK(agrees(product(a, packed), exact));
  CHECK(agrees(product<Real>(a, packed, {bias.data_ptr<Real>(), true, nullptr}), (exact + bias).relu()));
  CHECK(agrees(product<Real>(a, packed, {nullptr, false, mask.data_ptr<Real>()}), exact * (mask > 0)));
  const torch::Tensor transposed = b.t().contiguous();
  const RightSide<Real> turned{transposed.data_ptr<Real>(), k, n, true};
  CHECK(torch::equal(product(a, PackedMatrix<Real>(turned)), product(a, packed)));
  lodestone::nets::CacheAligned<Real> scratch;
  for (const RightSide<Real>& right : {plain, turned}) {
    torch::Tensor out = torch::full({m, n}, 777.0, a.scalar_type());
    lodestone::nets::multiply<Real>({a.data_ptr<Real>(), m, k}, right, scratch, out.data_ptr<Real>());
    CHECK(torch::equal(out, product(a, packed)));
  }
}

}  // namespace

TEST_CASE("Products of every kernel equal LibTorch's, whatever is left over at the edges", "[nets]") {
  const EveryKernel restore;
  torch::manual_seed(1);
  for (const std::string& kernel : gemm_kernels()) {
    INFO(kernel);
    select_gemm_kernels(kernel);
    CHECK(lodestone::nets::gemm_kernel_name() == kernel);
    for (const std::int64_t m : {1, 5, 12, 13, 64}) {
      for (const std::int64_t k : {1, 7, 33, 100}) {
        for (const std::int64_t n : {1, 2, 15, 16, 17, 32, 45, 80}) {
          check_products<float>(m, k, n, 1e-6);
          check_products<double>(m, k, n, 1e-14);
        }
      }
    }
  }
}

TEST_CASE("A row's product does not depend on the rows around it", "[nets]") {
  const EveryKernel restore;
  torch::manual_seed(2);
  const torch::Tensor a = random_matrix<float>(50, 37);
  const torch::Tensor b = random_matrix<float>(37, 40);
  for (const std::string& kernel : gemm_kernels()) {
    INFO(kernel);
    select_gemm_kernels(kernel);
    const PackedMatrix<float> packed({b.data_ptr<float>(), 37, 40});
    const torch::Tensor whole = product(a, packed);
    for (const std::int64_t rows : {1, 11, 12, 30}) {
      CHECK(torch::equal(product(a.narrow(0, 3, rows).contiguous(), packed), whole.narrow(0, 3, rows)));
    }
  }
}

TEST_CASE("The kernels for AVX2 and AVX-512 agree to the last bit", "[nets]") {
  const EveryKernel restore;
  torch::manual_seed(3);
  const torch::Tensor a = random_matrix<float>(50, 300);
  const torch::Tensor b = random_matrix<float>(300, 70);
  std::vector<torch::Tensor> results;
  for (const std::string& kernel : gemm_kernels()) {
    if (kernel == "generic")
      continue;  // multiplies and adds in two roundings where there is no instruction for both
    select_gemm_kernels(kernel);
    results.push_back(product(a, PackedMatrix<float>({b.data_ptr<float>(), 300, 70})));
  }
  for (const torch::Tensor& result : results) CHECK(torch::equal(result, results.front()));
}

TEST_CASE("A transpose with padded rows is the transpose", "[nets]") {
  const EveryKernel restore;
  for (const std::string& kernel : gemm_kernels()) {
    INFO(kernel);
    select_gemm_kernels(kernel);
    for (const auto& [rows, columns] :
         {std::pair(1, 1), std::pair(16, 16), std::pair(40, 23), std::pair(7, 65)}) {
      const torch::Tensor matrix = random_matrix<float>(rows, columns);
      const std::int64_t stride = padded_stride(rows);
      torch::Tensor out = torch::zeros({columns, stride});
      lodestone::nets::transpose(matrix.data_ptr<float>(), rows, columns, out.data_ptr<float>(), stride);
      CHECK(torch::equal(out.narrow(1, 0, rows), matrix.t()));
      CHECK(torch::equal(out.narrow(1, rows, stride - rows), torch::zeros({columns, stride - rows})));
    }
  }
}

TEST_CASE("What is not a number stays visible through a ReLU", "[nets]") {
  const EveryKernel restore;
  for (const std::string& kernel : gemm_kernels()) {
    select_gemm_kernels(kernel);
    const torch::Tensor a = torch::full({14, 20}, NAN);
    const torch::Tensor b = torch::ones({20, 40});
    const PackedMatrix<float> packed({b.data_ptr<float>(), 20, 40});
    CHECK(product<float>(a, packed, {nullptr, true, nullptr}).isnan().all().item<bool>());
  }
  CHECK_THROWS_AS(select_gemm_kernels("abacus"), lodestone::common::LogicFault);
}
