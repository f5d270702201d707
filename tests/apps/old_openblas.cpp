// Preloaded by blas_restart_test.py: an OpenBLAS that is older than the processor, as far as its name tells.

#include <cstdlib>

extern "C" const char* openblas_get_corename() {
  const char* told = std::getenv("OPENBLAS_CORETYPE");
  const char* chosen = std::getenv("CHOSEN_CORE");
  return told != nullptr ? told : chosen;
}
