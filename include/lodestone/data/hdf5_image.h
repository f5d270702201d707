#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lodestone::data {

/// An HDF5 file that is made in memory, for other programs' formats: groups, arrays and attributes, in the
/// form of HDF5 1.8. The same content gives the same bytes.
///
/// A `path` is that of a group or array in the file ("" is the root, "episode_0/infos" a group in a group);
/// parents come first. Every function throws IoError that names the file when HDF5 reports a fault.
class Hdf5Image {
 public:
  explicit Hdf5Image(std::string name);
  ~Hdf5Image();
  Hdf5Image(const Hdf5Image&) = delete;
  Hdf5Image& operator=(const Hdf5Image&) = delete;

  void add_group(const std::string& path);
  /// float64 or int64, row by row; the product of `shape` is the number of values.
  void add_array(const std::string& path, const std::vector<double>& values,
                 const std::vector<std::int64_t>& shape);
  void add_array(const std::string& path, const std::vector<std::int64_t>& values,
                 const std::vector<std::int64_t>& shape);
  /// [N] of what h5py reads as bool.
  void add_flags(const std::string& path, const std::vector<std::uint8_t>& flags);
  void add_attribute(const std::string& path, const char* attribute, std::int64_t value);
  void add_attribute(const std::string& path, const char* attribute, const std::string& value);

  std::string bytes() const;

 private:
  struct File;
  [[noreturn]] void fail(const std::string& what) const;

  std::string name_;
  std::unique_ptr<File> file_;
};

}  // namespace lodestone::data
