#include "lodestone/nets/blas.h"

#include <ATen/Parallel.h>
#include <dlfcn.h>

#include <mutex>

namespace lodestone::nets {

void use_one_blas_thread() {
  static std::once_flag once;
  std::call_once(once, [] {
    try {
      at::set_num_interop_threads(
          1);  // LibTorch refuses it once its pool has started, which is then idle anyway
    } catch (const std::exception&) {
    }
  });
  at::set_num_threads(1);
  using SetThreads = void (*)(int);
  // LibTorch links whichever libblas.so.3 the machine has, so OpenBLAS's own functions are looked up, not
  // linked.
  if (const auto set_threads =
          reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) {
    set_threads(1);
  }
}

}  // namespace lodestone::nets
