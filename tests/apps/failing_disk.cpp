// Preloaded into the program: the n-th call that changes a file under a folder kills the process or fails.
// What a kill at every point of a run would leave is found by trying every n (kill_points_test.py).
//   LODESTONE_DISK_FOLDER  only calls for files under it count
//   LODESTONE_DISK_AT      the call, from 1 on; 0 counts only
//   LODESTONE_DISK_FAULT   kill | short | EIO | ENOSPC
//   LODESTONE_DISK_COUNT   file that receives the number of calls at the end
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

const char* setting(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::atomic<long> calls{0};

template <typename F>
F real(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

bool counts(const char* path) {
  const char* folder = setting("LODESTONE_DISK_FOLDER");
  return *folder != '\0' && std::strncmp(path, folder, std::strlen(folder)) == 0;
}

bool counts(int file) {
  char link[64];
  char path[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return false;
  path[length] = '\0';
  return counts(path);
}

enum class Fault { kNone, kShort, kFails };

/// What happens to this call; a kill does not return.
Fault next_call() {
  if (++calls != std::atol(setting("LODESTONE_DISK_AT"))) return Fault::kNone;
  const char* fault = setting("LODESTONE_DISK_FAULT");
  if (std::strcmp(fault, "kill") == 0) {
    kill(getpid(), SIGKILL);
    pause();
  }
  if (std::strcmp(fault, "short") == 0) return Fault::kShort;
  errno = std::strcmp(fault, "ENOSPC") == 0 ? ENOSPC : EIO;
  return Fault::kFails;
}

struct AtExit {
  ~AtExit() {
    const char* file = setting("LODESTONE_DISK_COUNT");
    if (*file == '\0') return;
    if (std::FILE* out = std::fopen(file, "w")) {
      std::fprintf(out, "%ld\n", calls.load());
      std::fclose(out);
    }
  }
} at_exit;

/// A short write of one byte is no failure: who calls has to go on with the rest.
std::size_t shortened(Fault fault, std::size_t size) {
  return fault == Fault::kShort && size > 1 ? size / 2 : size;
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, std::size_t size) {
  static const auto original = real<ssize_t (*)(int, const void*, std::size_t)>("write");
  const Fault fault = counts(file) ? next_call() : Fault::kNone;
  return fault == Fault::kFails ? -1 : original(file, bytes, shortened(fault, size));
}

ssize_t writev(int file, const iovec* parts, int count) {
  static const auto original = real<ssize_t (*)(int, const iovec*, int)>("writev");
  const Fault fault = counts(file) ? next_call() : Fault::kNone;
  return fault == Fault::kFails ? -1 : original(file, parts, fault == Fault::kShort ? 1 : count);
}

ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t at) {
  static const auto original = real<ssize_t (*)(int, const void*, std::size_t, off_t)>("pwrite");
  const Fault fault = counts(file) ? next_call() : Fault::kNone;
  return fault == Fault::kFails ? -1 : original(file, bytes, shortened(fault, size), at);
}

ssize_t pwrite64(int file, const void* bytes, std::size_t size, off64_t at) {
  static const auto original = real<ssize_t (*)(int, const void*, std::size_t, off64_t)>("pwrite64");
  const Fault fault = counts(file) ? next_call() : Fault::kNone;
  return fault == Fault::kFails ? -1 : original(file, bytes, shortened(fault, size), at);
}

int fsync(int file) {
  static const auto original = real<int (*)(int)>("fsync");
  return counts(file) && next_call() == Fault::kFails ? -1 : original(file);
}

int fdatasync(int file) {
  static const auto original = real<int (*)(int)>("fdatasync");
  return counts(file) && next_call() == Fault::kFails ? -1 : original(file);
}

int ftruncate(int file, off_t size) {
  static const auto original = real<int (*)(int, off_t)>("ftruncate");
  return counts(file) && next_call() == Fault::kFails ? -1 : original(file, size);
}

int ftruncate64(int file, off64_t size) {
  static const auto original = real<int (*)(int, off64_t)>("ftruncate64");
  return counts(file) && next_call() == Fault::kFails ? -1 : original(file, size);
}

int rename(const char* from, const char* to) {
  static const auto original = real<int (*)(const char*, const char*)>("rename");
  return counts(to) && next_call() == Fault::kFails ? -1 : original(from, to);
}

int unlink(const char* path) {
  static const auto original = real<int (*)(const char*)>("unlink");
  return counts(path) && next_call() == Fault::kFails ? -1 : original(path);
}

}  // extern "C"
