#include "lodestone/nets/blas.h"

#include <catch2/catch.hpp>

using lodestone::nets::better_blas_core;

TEST_CASE("Other kernels are wanted only where AVX2 ones run on AVX-512 and nobody asked for them",
          "[nets]") {
  CHECK(better_blas_core("Haswell", true, "") == "SKYLAKEX");
  CHECK(better_blas_core("Zen", true, "") == "SKYLAKEX");
  CHECK(better_blas_core("Haswell", false, "").empty());
  CHECK(better_blas_core("Zen", false, "").empty());
  CHECK(better_blas_core("SkylakeX", true, "").empty());
  CHECK(better_blas_core("Cooperlake", true, "").empty());
  CHECK(better_blas_core("Haswell", true, "Haswell").empty());
  CHECK(better_blas_core("SkylakeX", true, "SKYLAKEX").empty());  // after the restart
  CHECK(better_blas_core("unknown", true, "").empty());
}
