#include "lodestone/inference/gemm_bf16.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <vector>

#include "gemm_pairs.h"
#include "gemm_tiles.h"
#include "lodestone/common/error.h"

namespace lodestone::inference {
namespace {

/// The nearest bfloat16, ties to even, as a float. Subnormal numbers count as zero.
float rounded(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  if ((bits & 0x7f800000U) == 0) bits &= 0x80000000U;
  if ((bits & 0x7fffffffU) > 0x7f800000U)
    bits |= 0x00400000U;  // NaN stays one
  else
    bits += 0x7fffU + (bits >> 16 & 1U);
  bits &= 0xffff0000U;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void multiply_rounded(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                      const Epilogue<float>& epilogue) {
  float* left = scratch.rounded_left.at_least(a.m * b.k);
  for (std::int64_t row = 0; row < a.m; ++row)
    std::transform(a.matrix + row * a.stride, a.matrix + row * a.stride + b.k, left + row * b.k, rounded);
  float* right = scratch.rounded_right.at_least(b.k * b.n);
  std::transform(b.matrix, b.matrix + b.k * b.n, right, rounded);
  multiply<float>({left, a.m, b.k}, {right, b.k, b.n, b.transposed}, scratch.panel, out, epilogue);
}

struct Bf16Kernel {
  const char* name;
  void (*multiply)(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                   const Epilogue<float>& epilogue);
};

std::vector<Bf16Kernel> runnable_bf16_kernels() {
  std::vector<Bf16Kernel> kernels;
#if defined(LODESTONE_X86_KERNELS)
  if (gemm_kernels().front() == "avx512") {
    static const bool tiles = request_tiles();
    if (tiles) kernels.push_back({"tiles", &multiply_by_tiles});
    if (has_pairs()) kernels.push_back({"pairs", &multiply_by_pairs});
  }
#endif
  kernels.push_back({"rounded", &multiply_rounded});
  return kernels;
}

Bf16Kernel& bf16_kernel_in_use() {
  static Bf16Kernel kernel = runnable_bf16_kernels().front();
  return kernel;
}

double measured_speedup() {
  constexpr std::int64_t kSide = 256;
  constexpr int kRounds = 40;
  std::vector<float> a(kSide * kSide, 0.5F), b(kSide * kSide, 0.25F), out(kSide * kSide);
  Bf16Scratch scratch;
  const LeftSide<float> left{a.data(), kSide, kSide};
  const RightSide<float> right{b.data(), kSide, kSide, /*transposed=*/true};
  const auto fastest_s = [&](const auto& product) {
    double best_s = 1e9;
    for (int round = 0; round < kRounds; ++round) {
      const auto start = std::chrono::steady_clock::now();
      product();
      best_s =
          std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best_s;
  };
  const double float32_s = fastest_s([&] { multiply<float>(left, right, scratch.panel, out.data()); });
  return float32_s / fastest_s([&] { multiply_bf16(left, right, scratch, out.data()); });
}

}  // namespace

std::vector<std::string> bf16_kernels() {
  std::vector<std::string> names;
  for (const Bf16Kernel& kernel : runnable_bf16_kernels()) names.emplace_back(kernel.name);
  return names;
}

void select_bf16_kernel(const std::string& name) {
  for (const Bf16Kernel& kernel : runnable_bf16_kernels()) {
    if (name != kernel.name) continue;
    bf16_kernel_in_use() = kernel;
    return;
  }
  LODESTONE_CHECK(false, "this processor has no bfloat16 kernel \"" + name + "\"");
}

void multiply_bf16(const LeftSide<float>& a, const RightSide<float>& b, Bf16Scratch& scratch, float* out,
                   const Epilogue<float>& epilogue) {
  if (std::min(b.k, b.n) < kLeastBf16Side) return multiply<float>(a, b, scratch.panel, out, epilogue);
  bf16_kernel_in_use().multiply(a, b, scratch, out, epilogue);
}

double bf16_speedup() {
  static const double speedup = measured_speedup();
  return speedup;
}

}  // namespace lodestone::inference
