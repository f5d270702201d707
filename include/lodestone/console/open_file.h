#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace lodestone::console {

/// A regular file that is open for reading: it stays the same one, whatever becomes of its name.
class OpenFile {
 public:
  /// `canonical_path`: absolute, and no part of it a link. Null where there is no such file, it is none that
  /// lies on a disk, it may not be read, or a part of its path has become a link meanwhile.
  static std::shared_ptr<const OpenFile> open(const std::string& canonical_path);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  const std::string& path() const { return path_; }
  /// When it was opened.
  std::uint64_t size_bytes() const { return size_bytes_; }
  /// Reads at most `count` bytes from `offset` on. How many there were: 0 at the end, or where the disk
  /// fails.
  std::size_t read(std::uint64_t offset, char* into, std::size_t count) const;

 private:
  OpenFile(int descriptor, std::string path, std::uint64_t size_bytes)
      : descriptor_(descriptor), path_(std::move(path)), size_bytes_(size_bytes) {}

  int descriptor_;
  std::string path_;
  std::uint64_t size_bytes_;
};

}  // namespace lodestone::console
