#pragma once

#include <string>

namespace lodestone::nets {

/// Gives every matrix product one thread: parallelism is between whole networks and shards of environments,
/// because inner threads make networks of this size slower. Sets LibTorch's intra-op and inter-op threads and
/// OpenBLAS's own count (when OpenBLAS is the BLAS). Call once at the start of a program, before the first
/// tensor operation; later calls are harmless.
void use_one_blas_thread();

/// Kernel family OpenBLAS chose for this processor ("Haswell", "SkylakeX", ...), or "unknown" for another
/// BLAS.
std::string blas_core_name();

/// The kernels OpenBLAS should be told to use, or "" when its own choice stands: a processor with AVX-512
/// that is newer than the library gets kernels for AVX2 ("Haswell", or "Zen", which are the same ones), half
/// as fast. `told` is the user's OPENBLAS_CORETYPE.
std::string better_blas_core(const std::string& chosen, bool has_avx512, const std::string& told);

/// OpenBLAS chooses its kernels when it is loaded, before main. Where it chose wrongly, sets
/// OPENBLAS_CORETYPE and starts the program anew with the same arguments, once: the variable that is then set
/// stops a second time. Returns when there is nothing to do, or when the restart fails (logged). Call first
/// of all.
void restart_with_better_blas_kernels(char** argv);

}  // namespace lodestone::nets
