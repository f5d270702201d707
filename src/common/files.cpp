#include "lodestone/common/files.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "lodestone/common/error.h"

namespace lodestone::common {
namespace fs = std::filesystem;
namespace {

std::string reason() { return std::strerror(errno); }

std::string parent_of(const std::string& path) {
  const fs::path parent = fs::path(path).lexically_normal().parent_path();
  return parent.empty() ? "." : parent.string();
}

/// Closes a descriptor whatever happens.
struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

void check_is_file(const struct stat& status, const std::string& path) {
  if (S_ISREG(status.st_mode)) return;
  const char* what = S_ISDIR(status.st_mode)    ? "a folder"
                     : S_ISFIFO(status.st_mode) ? "a pipe"
                     : S_ISSOCK(status.st_mode) ? "a socket"
                                                : "a device";
  throw IoError("cannot read " + path + ": it is " + what + ", not a file");
}

void rename_to(const std::string& staged, const std::string& path) {
  if (::rename(staged.c_str(), path.c_str()) != 0)
    throw IoError("cannot rename to " + path + ": " + reason());
  sync_path(parent_of(path));
}

}  // namespace

void check_is_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw IoError("cannot read " + path + ": " + reason());
  check_is_file(status, path);
}

std::string read_file(const std::string& path, std::size_t largest_bytes) {
  // Not waiting: somebody may have put a pipe there.
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
  struct stat status {};
  if (file.value < 0 || ::fstat(file.value, &status) != 0)
    throw IoError("cannot read " + path + ": " + reason());
  check_is_file(status, path);
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > largest_bytes)
    throw IoError(
        fmt::format("cannot read {}: it holds {} bytes, at most {} are read", path, size, largest_bytes));
  std::string content(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n = ::read(file.value, content.data() + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw IoError("cannot read " + path + ": " + reason());
    if (n == 0) break;  // cut short since
    done += static_cast<std::size_t>(n);
  }
  content.resize(done);
  return content;
}

void sync_path(const std::string& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.value < 0 || ::fsync(file.value) != 0) throw IoError("cannot sync " + path + ": " + reason());
}

void write_file_atomically(const std::string& path, std::string_view content) {
  const std::string staged = path + ".tmp" + std::to_string(::getpid());
  try {
    {
      const Descriptor file{::open(staged.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
      if (file.value < 0) throw IoError("cannot write " + path + ": " + reason());
      for (std::size_t written = 0; written < content.size();) {
        const ssize_t n = ::write(file.value, content.data() + written, content.size() - written);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
          throw IoError("cannot write " + path + ": " + reason() + "; the file is as it was before");
        written += static_cast<std::size_t>(n);
      }
      if (::fsync(file.value) != 0) throw IoError("cannot write " + path + ": " + reason());
    }
    rename_to(staged, path);
  } catch (const IoError&) {
    ::unlink(staged.c_str());
    throw;
  }
}

void replace_file(const std::string& staged, const std::string& path) {
  sync_path(staged);  // else a power cut may leave the name with nothing in it
  rename_to(staged, path);
}

void remove_file(const std::string& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT)
    throw IoError("cannot remove " + path + ": " + reason());
}

void replace_folder(const std::string& staged, const std::string& path) {
  if (!fs::exists(path)) {
    if (::rename(staged.c_str(), path.c_str()) != 0)
      throw IoError("cannot rename to " + path + ": " + reason());
  } else {
    // Exchanging the names leaves no moment without a whole folder at `path`.
    if (::renameat2(AT_FDCWD, staged.c_str(), AT_FDCWD, path.c_str(), RENAME_EXCHANGE) != 0)
      throw IoError("cannot exchange " + path + ": " + reason());
    std::error_code ignored;  // what remains of the old content does no harm
    fs::remove_all(staged, ignored);
  }
  sync_path(parent_of(path));
}

void make_folders(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw IoError("cannot make folder " + path + ": " + error.message());
}

std::string sha256(std::string_view content) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  LODESTONE_CHECK(
      EVP_Digest(content.data(), content.size(), digest.data(), &size, EVP_sha256(), nullptr) == 1,
      "SHA-256 of " + std::to_string(content.size()) + " bytes failed");
  std::string text;
  for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

}  // namespace lodestone::common
