#include "gemm_kernel_body.h"

namespace lodestone::inference {

GemmKernelSet generic_gemm_kernels() {
  return {"generic", Kernel<float, 4, 6>::table(), Kernel<double, 2, 6>::table()};
}

}  // namespace lodestone::inference
