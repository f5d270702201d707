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

}  // namespace lodestone::nets
