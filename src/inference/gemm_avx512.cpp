#include "gemm_kernel_body.h"

namespace lodestone::inference {

GemmKernelSet avx512_gemm_kernels() {
  return {"avx512", Kernel<float, 16, 12>::table(), Kernel<double, 8, 12>::table()};
}

}  // namespace lodestone::inference
