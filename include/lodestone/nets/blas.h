#pragma once

namespace lodestone::nets {

/// Gives every matrix product one thread: parallelism is between whole networks and shards of environments,
/// because inner threads make networks of this size slower. Sets LibTorch's intra-op and inter-op threads and
/// OpenBLAS's own count (when OpenBLAS is the BLAS). Call once at the start of a program, before the first
/// tensor operation; later calls are harmless.
void use_one_blas_thread();

}  // namespace lodestone::nets
