#include "lodestone/console/open_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <climits>

namespace lodestone::console {

namespace {

/// Where an open file lies now.
std::string place_of(int descriptor) {
  char place[PATH_MAX];
  const ssize_t length =
      ::readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), place, sizeof place);
  return length < 0 ? "" : std::string(place, static_cast<std::size_t>(length));
}

}  // namespace

std::shared_ptr<const OpenFile> OpenFile::open(const std::string& canonical_path) {
  struct stat named {};  // first, as to open a device can do something
  if (::lstat(canonical_path.c_str(), &named) != 0 || !S_ISREG(named.st_mode)) return nullptr;
  const int descriptor = ::open(canonical_path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return nullptr;
  struct stat opened {};
  if (::fstat(descriptor, &opened) != 0 || !S_ISREG(opened.st_mode) ||
      place_of(descriptor) != canonical_path) {
    ::close(descriptor);
    return nullptr;
  }
  return std::shared_ptr<const OpenFile>(
      new OpenFile(descriptor, canonical_path, static_cast<std::uint64_t>(opened.st_size)));
}

OpenFile::~OpenFile() { ::close(descriptor_); }

std::size_t OpenFile::read(std::uint64_t offset, char* into, std::size_t count) const {
  const ssize_t got = ::pread(descriptor_, into, count, static_cast<off_t>(offset));
  return got < 0 ? 0 : static_cast<std::size_t>(got);
}

}  // namespace lodestone::console
