#include "hdf5_handle.h"

#include <algorithm>

namespace lodestone::data {
namespace {

// Small arrays live inside their object header.
constexpr std::size_t kCompactBytes = 16384;
constexpr std::size_t kImageStep = 1 << 20;      // bytes by which a file in memory grows
constexpr std::size_t kLongestText = 16 << 20;   // bytes of an attribute
constexpr std::size_t kLargestChunk = 64 << 20;  // bytes, which are unpacked at once

herr_t keep_innermost(unsigned depth, const H5E_error2_t* error, void* text) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

bool write_scalar(hid_t object, const char* name, hid_t type, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const bool exists = H5Aexists(object, name) > 0;
  const Handle attribute(exists ? H5Aopen(object, name, H5P_DEFAULT)
                                : H5Acreate2(object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  return attribute.valid() && H5Awrite(attribute.get(), type, value) >= 0;
}

bool read_scalar(hid_t object, const char* name, H5T_class_t kind, hid_t memory_type, void* value) {
  if (H5Aexists(object, name) <= 0) return false;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) return false;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  if (H5Tget_class(type.get()) != kind || H5Sget_simple_extent_npoints(space.get()) != 1) return false;
  return H5Aread(attribute.get(), memory_type, value) >= 0;
}

}  // namespace

void silence_hdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

Handle within_file(hid_t property_class) {
  const auto refuse = [](const char*, const char*, const char*, const char*, unsigned*, hid_t,
                         void*) -> herr_t { return -1; };
  Handle access(H5Pcreate(property_class), H5Pclose);
  H5Pset_elink_cb(access.get(), refuse, nullptr);
  return access;
}

std::string because_of_hdf5() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &text);
  return text.empty() ? "" : " (" + text + ")";
}

bool write_attribute(hid_t object, const char* name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), value.empty() ? 1 : value.size());
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return write_scalar(object, name, type.get(), value.c_str());
}

bool write_attribute(hid_t object, const char* name, double value) {
  return write_scalar(object, name, H5T_NATIVE_DOUBLE, &value);
}

bool write_attribute(hid_t object, const char* name, std::int64_t value) {
  return write_scalar(object, name, H5T_NATIVE_INT64, &value);
}

bool read_attribute(hid_t object, const char* name, std::string& value) {
  if (H5Aexists(object, name) <= 0) return false;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) return false;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) > 0 ||
      H5Tget_size(type.get()) > kLongestText || H5Sget_simple_extent_npoints(space.get()) != 1)
    return false;
  value.assign(H5Tget_size(type.get()), '\0');
  if (H5Aread(attribute.get(), type.get(), value.data()) < 0) return false;
  value.resize(value.find_last_not_of('\0') + 1);
  return true;
}

bool read_attribute(hid_t object, const char* name, double& value) {
  return read_scalar(object, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, &value);
}

bool read_attribute(hid_t object, const char* name, std::int64_t& value) {
  return read_scalar(object, name, H5T_INTEGER, H5T_NATIVE_INT64, &value);
}

Handle open_group(hid_t parent, const char* name) {
  return Handle(H5Gopen2(parent, name, within_file(H5P_GROUP_ACCESS).get()), H5Gclose);
}

Handle create_group(hid_t parent, const char* name) {
  const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);
  return Handle(H5Gcreate2(parent, name, H5P_DEFAULT, creation.get(), H5P_DEFAULT), H5Gclose);
}

Handle create_file(const std::string& path, hid_t access) {
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);
  return Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access), H5Fclose);
}

Handle create_memory_file(const std::string& name) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kImageStep, false);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18);
  return create_file(name, access.get());
}

std::string memory_of(const Handle& file) {
  // From the memory itself: H5Fget_file_image leaves a superblock of this version without its checksum.
  void* memory = nullptr;
  if (!file.valid() || H5Fflush(file.get(), H5F_SCOPE_LOCAL) < 0) return "";
  const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
  if (size <= 0 || H5Fget_vfd_handle(file.get(), H5P_DEFAULT, &memory) < 0) return "";
  return {*static_cast<char**>(memory), static_cast<std::size_t>(size)};
}

bool is_stored_plainly(hid_t dataset) {
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(creation.get());
  if (H5Pget_external_count(creation.get()) != 0 || layout == H5D_VIRTUAL || layout == H5D_LAYOUT_ERROR)
    return false;
  if (layout != H5D_CHUNKED) return true;
  hsize_t chunk[2] = {1, 1};
  const int rank = H5Pget_chunk(creation.get(), 2, chunk);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const std::size_t most = kLargestChunk / std::max<std::size_t>(1, H5Tget_size(type.get()));
  return rank >= 1 && rank <= 2 && chunk[0] <= most && chunk[1] <= most / std::max<hsize_t>(1, chunk[0]);
}

bool write_array(hid_t group, const char* name, hid_t file_type, hid_t memory_type, const void* values,
                 const std::vector<hsize_t>& shape) {
  hsize_t count = 1;
  for (const hsize_t extent : shape) count *= extent;
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (count * H5Tget_size(file_type) <= kCompactBytes) H5Pset_layout(creation.get(), H5D_COMPACT);
  H5Pset_obj_track_times(creation.get(), false);
  const Handle dataset(
      H5Dcreate2(group, name, file_type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT), H5Dclose);
  return dataset.valid() && H5Dwrite(dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
}

}  // namespace lodestone::data
