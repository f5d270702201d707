#include "gemm_kernel_body.h"

namespace lodestone::inference {

GemmKernelSet avx2_gemm_kernels() {
  return {"avx2", Kernel<float, 8, 6>::table(), Kernel<double, 4, 6>::table()};
}

}  // namespace lodestone::inference
