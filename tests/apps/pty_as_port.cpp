// Preloaded: makes a pseudo-terminal, opened as /dev/./pts/N, pass for a serial device, so that libserialport
// can be tested without one. It lacks modem lines and a place in /sys.
#include <dlfcn.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstring>

namespace {
bool is_port(const char* path) { return std::strncmp(path, "/sys/class/tty/./pts/", 21) == 0; }
}  // namespace

extern "C" int ioctl(int file, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  using Ioctl = int (*)(int, unsigned long, ...);
  static const auto next = reinterpret_cast<Ioctl>(dlsym(RTLD_NEXT, "ioctl"));
  const int result = next(file, request, argument);
  if (result == 0 || errno != ENOTTY) return result;
  if (request == TIOCMGET) *static_cast<int*>(argument) = 0;
  const bool modem_lines =
      request == TIOCMGET || request == TIOCMSET || request == TIOCMBIC || request == TIOCMBIS;
  return modem_lines ? 0 : result;
}

// What lstat was in the C library that libserialport was built for.
extern "C" int __lxstat(int version, const char* path, struct stat* found) noexcept {
  using Lstat = int (*)(int, const char*, struct stat*);
  static const auto next = reinterpret_cast<Lstat>(dlsym(RTLD_NEXT, "__lxstat"));
  if (!is_port(path)) return next(version, path, found);
  *found = {};
  found->st_mode = S_IFLNK;
  return 0;
}

extern "C" ssize_t readlink(const char* path, char* text, size_t size) noexcept {
  using Readlink = ssize_t (*)(const char*, char*, size_t);
  static const auto next = reinterpret_cast<Readlink>(dlsym(RTLD_NEXT, "readlink"));
  if (!is_port(path)) return next(path, text, size);
  static const char target[] = "../../devices/virtual/tty/pts";
  std::memcpy(text, target, sizeof target - 1);
  return sizeof target - 1;
}
