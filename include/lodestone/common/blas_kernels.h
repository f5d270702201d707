#pragma once

#include <string>

namespace lodestone::common {

/// Instruction sets of this processor, as far as OpenBLAS has kernels for them.
struct VectorUnits {
  bool avx2 = false;    ///< with FMA
  bool avx512 = false;  ///< F, BW, DQ and VL
};
VectorUnits vector_units();

/// Kernel family that the OpenBLAS of this program chose ("Haswell", "SkylakeX", ...), or "unknown" where the
/// program has another BLAS or none.
std::string blas_core_name();

/// The kernels OpenBLAS should be told to use, or "" when its own choice stands. A processor that is newer
/// than the library gets kernels for an older one, down to SSE3 ("Prescott"), at a fifth of the speed:
/// AVX-512 should run "SKYLAKEX", AVX2 "HASWELL". `told` is the user's OPENBLAS_CORETYPE, which stands.
std::string better_blas_core(const std::string& chosen, VectorUnits has, const std::string& told);

/// One line for somebody who measures where the BLAS, on kernels `core`, runs below half the pace of our own
/// matrix product (both in FLOP/s), else empty.
std::string slow_blas_note(const std::string& core, double blas_flop_per_s, double own_flop_per_s);

/// OpenBLAS chooses its kernels when it is loaded, before main. Where it chose wrongly, sets
/// OPENBLAS_CORETYPE and starts the program anew with the same arguments, once: the variable that is then set
/// stops a second time. Returns when there is nothing to do, or when the restart fails (logged). Call first
/// of all.
void restart_with_better_blas_kernels(char** argv);

}  // namespace lodestone::common
