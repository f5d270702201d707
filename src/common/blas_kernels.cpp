#include "lodestone/common/blas_kernels.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "lodestone/common/log.h"

namespace lodestone::common {

namespace {
constexpr const char* kVariable = "OPENBLAS_CORETYPE";
}

VectorUnits vector_units() {
  VectorUnits has;
#if defined(__x86_64__)
  __builtin_cpu_init();
  has.avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  has.avx512 = __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
               __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
#endif
  return has;
}

std::string blas_core_name() {
  // LibTorch links whichever libblas.so.3 the machine has, so OpenBLAS's own functions are looked up, not
  // linked.
  using CoreName = char* (*)();
  const auto core_name = reinterpret_cast<CoreName>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  return core_name != nullptr ? core_name() : "unknown";
}

std::string better_blas_core(const std::string& chosen, VectorUnits has, const std::string& told) {
  if (!told.empty() || chosen == "unknown") return "";
  const bool for_avx512 = chosen == "SkylakeX" || chosen == "Cooperlake" || chosen == "SapphireRapids";
  const bool for_avx2 = chosen == "Haswell" || chosen == "Zen";
  if (has.avx512) return for_avx512 ? "" : "SKYLAKEX";
  if (has.avx2) return for_avx512 || for_avx2 ? "" : "HASWELL";
  return "";
}

std::string slow_blas_note(const std::string& core, double blas_flop_per_s, double own_flop_per_s) {
  if (!(blas_flop_per_s < 0.5 * own_flop_per_s)) return "";
  return "the BLAS (kernels " + core + ") runs at " +
         std::to_string(std::lround(100.0 * blas_flop_per_s / own_flop_per_s)) +
         " % of our own product's pace: LibTorch is slow on this machine; set " + kVariable +
         " to kernels of this processor, or install a newer OpenBLAS";
}

void restart_with_better_blas_kernels(char** argv) {
  const char* told = std::getenv(kVariable);
  const std::string chosen = blas_core_name();
  const std::string better = better_blas_core(chosen, vector_units(), told != nullptr ? told : "");
  if (better.empty() || setenv(kVariable, better.c_str(), 1) != 0) return;
  log_info("OpenBLAS chose its " + chosen + " kernels, this processor can do more: starting again with " +
           kVariable + "=" + better + "; one of your own would stand");
  execv("/proc/self/exe", argv);
  log_warning(std::string("could not start again: ") + std::strerror(errno) + "; going on with the " +
              chosen + " kernels");
}

}  // namespace lodestone::common
