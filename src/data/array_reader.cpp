#include "array_reader.h"

#include "lodestone/common/error.h"

namespace lodestone::data {

using common::DataError;

template <class Value>
std::size_t ArrayReader::read_as(hid_t memory_type, hid_t group, const char* name, hsize_t columns,
                                 std::vector<Value>& values, const std::string& place) {
  const Handle dataset(H5Dopen2(group, name, within_file(H5P_DATASET_ACCESS).get()), H5Dclose);
  if (!dataset.valid()) throw DataError(place + ": dataset '" + name + "' is missing or damaged");
  const Handle space(H5Dget_space(dataset.get()), H5Sclose);
  hsize_t shape[2] = {0, 1};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1 || rank > 2 || (rank == 1 && columns > 1) ||
      H5Sget_simple_extent_dims(space.get(), shape, nullptr) != rank || shape[1] != columns)
    throw DataError(place + ": dataset '" + name + "' has another shape than [rows, " +
                    std::to_string(columns) + "]");
  if (!is_stored_plainly(dataset.get()))
    throw DataError(place + ": dataset '" + name +
                    "' lies in other files, or in chunks of more than 64 MiB: copy it with h5repack");
  if (shape[0] > budget_bytes_ / (columns * sizeof(Value)))
    throw DataError(place + ": dataset '" + name + "' asks for " + std::to_string(shape[0]) +
                    " rows, more than the file can hold");
  budget_bytes_ -= shape[0] * columns * sizeof(Value);
  values.resize(shape[0] * columns);
  if (!values.empty() &&
      H5Dread(dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw DataError(place + ": dataset '" + name + "' cannot be read" + because_of_hdf5());
  return shape[0];
}

std::size_t ArrayReader::read(hid_t group, const char* name, hsize_t columns, std::vector<double>& values,
                              const std::string& place) {
  return read_as(H5T_NATIVE_DOUBLE, group, name, columns, values, place);
}

std::size_t ArrayReader::read(hid_t group, const char* name, hsize_t columns,
                              std::vector<std::uint8_t>& values, const std::string& place) {
  return read_as(H5T_NATIVE_UINT8, group, name, columns, values, place);
}

std::size_t ArrayReader::read(hid_t group, const char* name, hsize_t columns,
                              std::vector<std::int64_t>& values, const std::string& place) {
  return read_as(H5T_NATIVE_INT64, group, name, columns, values, place);
}

}  // namespace lodestone::data
