// Preloaded into the program: opening a file whose name holds "planted-bug" throws what no verb expects, as a
// bug would (exit_codes_test.py).
#include <dlfcn.h>
#include <fcntl.h>

#include <cstdarg>
#include <cstring>
#include <stdexcept>

extern "C" int open(const char* path, int flags, ...) {
  if (std::strstr(path, "planted-bug") != nullptr) throw std::logic_error("a planted bug");
  va_list rest;
  va_start(rest, flags);
  const int mode = va_arg(rest, int);
  va_end(rest);
  static const auto real = reinterpret_cast<int (*)(const char*, int, ...)>(dlsym(RTLD_NEXT, "open"));
  return real(path, flags, mode);
}
