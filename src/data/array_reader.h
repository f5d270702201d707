#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hdf5_handle.h"

namespace lodestone::data {

/// Reads arrays of one HDF5 file, together no more than the file can hold: no recording shrinks to a 64th of
/// its numbers, but a shape alone, or links to one array from everywhere, ask for as much as they like.
class ArrayReader {
 public:
  explicit ArrayReader(std::uintmax_t file_bytes) : budget_bytes_(kBytesPerByte * file_bytes) {}

  /// Reads [rows, columns] (one column: [rows], or [rows, 1]) and returns the rows. Throws DataError that
  /// begins with `place` where the array is missing, damaged, of another shape, in other files or too large.
  std::size_t read(hid_t group, const char* name, hsize_t columns, std::vector<double>& values,
                   const std::string& place);
  std::size_t read(hid_t group, const char* name, hsize_t columns, std::vector<std::uint8_t>& values,
                   const std::string& place);
  std::size_t read(hid_t group, const char* name, hsize_t columns, std::vector<std::int64_t>& values,
                   const std::string& place);

 private:
  static constexpr hsize_t kBytesPerByte = 64;

  template <class Value>
  std::size_t read_as(hid_t memory_type, hid_t group, const char* name, hsize_t columns,
                      std::vector<Value>& values, const std::string& place);

  hsize_t budget_bytes_;
};

}  // namespace lodestone::data
