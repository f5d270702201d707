#include "lodestone/inference/gemm.h"

#include <algorithm>
#include <type_traits>

#include "gemm_kernels.h"
#include "lodestone/common/error.h"

namespace lodestone::inference {
namespace {

std::vector<GemmKernelSet> runnable_kernels() {
  std::vector<GemmKernelSet> sets;
#if defined(LODESTONE_X86_KERNELS)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    sets.push_back(avx512_gemm_kernels());
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) sets.push_back(avx2_gemm_kernels());
#endif
  sets.push_back(generic_gemm_kernels());
  return sets;
}

GemmKernelSet& kernels_in_use() {
  static GemmKernelSet set = runnable_kernels().front();
  return set;
}

template <class Real>
const GemmKernels<Real>& kernels() {
  if constexpr (std::is_same_v<Real, float>) {
    return kernels_in_use().of_float;
  } else {
    return kernels_in_use().of_double;
  }
}

}  // namespace

std::vector<std::string> gemm_kernels() {
  std::vector<std::string> names;
  for (const GemmKernelSet& set : runnable_kernels()) names.emplace_back(set.name);
  return names;
}

std::string gemm_kernel_name() { return kernels_in_use().name; }

void select_gemm_kernels(const std::string& name) {
  for (const GemmKernelSet& set : runnable_kernels()) {
    if (name != set.name) continue;
    kernels_in_use() = set;
    return;
  }
  LODESTONE_CHECK(false, "this processor has no gemm kernels \"" + name + "\"");
}

namespace {

/// Panels of a matrix of `n` columns, one after the other.
template <class Real>
struct Panel {
  std::int64_t first, columns;  // of the matrix
  std::int64_t width;           // as packed
};

template <class Real, class Visit>
void for_each_panel(std::int64_t n, const Visit& visit) {
  const std::int64_t width = kernels<Real>().width;
  for (std::int64_t j = 0; j < n; j += width) {
    const std::int64_t columns = std::min(width, n - j);
    visit(Panel<Real>{j, columns, columns > width / 2 ? width : width / 2});
  }
}

template <class Real>
void pack_panel(const RightSide<Real>& b, const Panel<Real>& panel, Real* out) {
  if (panel.columns < panel.width) std::fill_n(out, b.k * panel.width, Real(0));
  if (b.transposed) {
    kernels<Real>().transpose(b.matrix + panel.first * b.k, panel.columns, b.k, b.k, out, panel.width);
    return;
  }
  kernels<Real>().pack(b.matrix + panel.first, b.k, b.n, panel.columns, out, panel.width);
}

template <class Real>
void multiply_panel(const LeftSide<Real>& a, std::int64_t k, const Real* packed, const Panel<Real>& panel,
                    std::int64_t n, Real* out, Epilogue<Real> epilogue) {
  if (epilogue.bias != nullptr) epilogue.bias += panel.first;
  if (epilogue.mask != nullptr) epilogue.mask += panel.first;
  kernels<Real>().multiply(a.matrix, a.m, a.stride, k, packed, panel.columns, out + panel.first, n, epilogue);
}

}  // namespace

template <class Real>
Real* CacheAligned<Real>::at_least(std::int64_t count) {
  const auto bytes = static_cast<std::size_t>(count) * sizeof(Real);
  lines_.resize(std::max(lines_.size(), (bytes + sizeof(Line) - 1) / sizeof(Line)));
  return reinterpret_cast<Real*>(lines_.data());
}

template <class Real>
PackedMatrix<Real>::PackedMatrix(const RightSide<Real>& b) : k_(b.k), n_(b.n) {
  std::int64_t columns = 0;
  for_each_panel<Real>(n_, [&](const Panel<Real>& panel) { columns += panel.width; });
  Real* out = storage_.at_least(k_ * columns);
  for_each_panel<Real>(n_, [&](const Panel<Real>& panel) {
    pack_panel(b, panel, out);
    out += k_ * panel.width;
  });
}

template <class Real>
void multiply(const LeftSide<Real>& a, const PackedMatrix<Real>& b, Real* out,
              const Epilogue<Real>& epilogue) {
  const Real* packed = b.panels();
  for_each_panel<Real>(b.n(), [&](const Panel<Real>& panel) {
    multiply_panel(a, b.k(), packed, panel, b.n(), out, epilogue);
    packed += b.k() * panel.width;
  });
}

template <class Real>
void multiply(const LeftSide<Real>& a, const RightSide<Real>& b, CacheAligned<Real>& scratch, Real* out,
              const Epilogue<Real>& epilogue) {
  Real* packed = scratch.at_least(b.k * kernels<Real>().width);
  for_each_panel<Real>(b.n, [&](const Panel<Real>& panel) {
    pack_panel(b, panel, packed);
    multiply_panel(a, b.k, packed, panel, b.n, out, epilogue);
  });
}

template <class Real>
void transpose(const Real* matrix, std::int64_t rows, std::int64_t columns, Real* out,
               std::int64_t out_stride) {
  kernels<Real>().transpose(matrix, rows, columns, columns, out, out_stride);
}

template class CacheAligned<float>;
template class CacheAligned<std::uint16_t>;
template class CacheAligned<std::uint32_t>;
template class PackedMatrix<float>;
template void multiply(const LeftSide<float>&, const PackedMatrix<float>&, float*, const Epilogue<float>&);
template void multiply(const LeftSide<float>&, const RightSide<float>&, CacheAligned<float>&, float*,
                       const Epilogue<float>&);
template class CacheAligned<double>;
template class PackedMatrix<double>;
template void multiply(const LeftSide<double>&, const PackedMatrix<double>&, double*,
                       const Epilogue<double>&);
template void multiply(const LeftSide<double>&, const RightSide<double>&, CacheAligned<double>&, double*,
                       const Epilogue<double>&);
template void transpose(const float*, std::int64_t, std::int64_t, float*, std::int64_t);
template void transpose(const double*, std::int64_t, std::int64_t, double*, std::int64_t);

}  // namespace lodestone::inference
