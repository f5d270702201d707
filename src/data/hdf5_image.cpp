#include "lodestone/data/hdf5_image.h"

#include "hdf5_handle.h"
#include "lodestone/common/error.h"

namespace lodestone::data {
namespace {

std::vector<hsize_t> extents(const std::vector<std::int64_t>& shape) { return {shape.begin(), shape.end()}; }

/// h5py's bool: an enumeration of one byte.
Handle flag_type() {
  Handle type(H5Tenum_create(H5T_STD_I8LE), H5Tclose);
  for (const auto& [name, value] : {std::pair{"FALSE", std::int8_t{0}}, std::pair{"TRUE", std::int8_t{1}}})
    H5Tenum_insert(type.get(), name, &value);
  return type;
}

}  // namespace

struct Hdf5Image::File {
  Handle root;
  Handle flags;
};

Hdf5Image::Hdf5Image(std::string name) : name_(std::move(name)), file_(std::make_unique<File>()) {
  silence_hdf5();
  file_->root = create_memory_file(name_);
  file_->flags = flag_type();
  if (!file_->root.valid() || !file_->flags.valid()) fail("the file");
}

Hdf5Image::~Hdf5Image() = default;

void Hdf5Image::fail(const std::string& what) const {
  throw common::IoError("cannot make " + name_ + ": HDF5 reports a fault at " + what + because_of_hdf5());
}

void Hdf5Image::add_group(const std::string& path) {
  if (!create_group(file_->root.get(), path.c_str()).valid()) fail(path);
}

void Hdf5Image::add_array(const std::string& path, const std::vector<double>& values,
                          const std::vector<std::int64_t>& shape) {
  if (!write_array(file_->root.get(), path.c_str(), H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(),
                   extents(shape)))
    fail(path);
}

void Hdf5Image::add_array(const std::string& path, const std::vector<std::int64_t>& values,
                          const std::vector<std::int64_t>& shape) {
  if (!write_array(file_->root.get(), path.c_str(), H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(),
                   extents(shape)))
    fail(path);
}

void Hdf5Image::add_flags(const std::string& path, const std::vector<std::uint8_t>& flags) {
  const hid_t type = file_->flags.get();
  if (!write_array(file_->root.get(), path.c_str(), type, type, flags.data(), {flags.size()})) fail(path);
}

void Hdf5Image::add_attribute(const std::string& path, const char* attribute, std::int64_t value) {
  const Handle object(H5Oopen(file_->root.get(), path.empty() ? "/" : path.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.valid() || !write_attribute(object.get(), attribute, value)) fail(path);
}

void Hdf5Image::add_attribute(const std::string& path, const char* attribute, const std::string& value) {
  const Handle object(H5Oopen(file_->root.get(), path.empty() ? "/" : path.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.valid() || !write_attribute(object.get(), attribute, value)) fail(path);
}

std::string Hdf5Image::bytes() const {
  std::string image = memory_of(file_->root);
  if (image.empty()) fail("its end");
  return image;
}

}  // namespace lodestone::data
