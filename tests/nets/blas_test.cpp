#include "lodestone/nets/blas.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "lodestone/common/blas_kernels.h"

using namespace lodestone;

TEST_CASE("A test program multiplies by the kernels that the program takes", "[nets]") {
  nets::use_one_blas_thread();  // LibTorch, and with it the BLAS, is linked
  const char* told = std::getenv("OPENBLAS_CORETYPE");
  CAPTURE(common::blas_core_name());
  CHECK(
      common::better_blas_core(common::blas_core_name(), common::vector_units(), told != nullptr ? told : "")
          .empty());
}
