#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include "lodestone/common/blas_kernels.h"

int main(int argc, char** argv) {
  lodestone::common::restart_with_better_blas_kernels(argv);  // as the program does
  return Catch::Session().run(argc, argv);
}
