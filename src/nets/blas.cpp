#include "lodestone/nets/blas.h"

#include <ATen/Parallel.h>
#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "lodestone/common/log.h"

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

std::string blas_core_name() {
  using CoreName = char* (*)();
  const auto core_name = reinterpret_cast<CoreName>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  return core_name != nullptr ? core_name() : "unknown";
}

std::string better_blas_core(const std::string& chosen, bool has_avx512, const std::string& told) {
  return has_avx512 && told.empty() && (chosen == "Haswell" || chosen == "Zen") ? "SKYLAKEX" : "";
}

void restart_with_better_blas_kernels(char** argv) {
#if defined(LODESTONE_X86_KERNELS)
  constexpr const char* kVariable = "OPENBLAS_CORETYPE";
  const char* told = std::getenv(kVariable);
  const std::string chosen = blas_core_name();
  __builtin_cpu_init();
  const bool has_avx512 = __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                          __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  const std::string better = better_blas_core(chosen, has_avx512, told != nullptr ? told : "");
  if (better.empty()) return;
  if (setenv(kVariable, better.c_str(), 1) != 0) return;
  common::log_info("OpenBLAS chose its " + chosen +
                   " kernels on a processor with AVX-512: starting again with " + kVariable + "=" + better +
                   " (--no-reexec keeps them)");
  execv("/proc/self/exe", argv);
  common::log_warning(std::string("could not start again: ") + std::strerror(errno) + "; going on with the " +
                      chosen + " kernels");
#endif
}

}  // namespace lodestone::nets
