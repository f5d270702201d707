#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lodestone::data {

/// Owns one HDF5 identifier. `close` is the H5?close function of its kind.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
    return *this;
  }
  ~Handle() { reset(); }

  void reset() noexcept {
    if (id_ >= 0) close_(std::exchange(id_, -1));
  }
  bool valid() const { return id_ >= 0; }
  hid_t get() const { return id_; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

/// Keeps HDF5 from printing its own error stack: faults are reported once, as one line.
void silence_hdf5();

/// Access properties, H5P_GROUP_ACCESS or H5P_DATASET_ACCESS, with which a link into another file cannot be
/// opened: a recording is one file, and the other may be a device, or nobody's business.
Handle within_file(hid_t property_class);

/// What HDF5 said last, its innermost message, as " (message)"; empty when it said nothing.
std::string because_of_hdf5();

/// Scalar attributes of a group. The read functions return false when the attribute is absent or of another
/// type.
bool write_attribute(hid_t object, const char* name, const std::string& value);
bool write_attribute(hid_t object, const char* name, double value);
bool write_attribute(hid_t object, const char* name, std::int64_t value);
bool read_attribute(hid_t object, const char* name, std::string& value);
bool read_attribute(hid_t object, const char* name, double& value);
bool read_attribute(hid_t object, const char* name, std::int64_t& value);

/// A group of this file; not valid where it is absent, or in another one.
Handle open_group(hid_t parent, const char* name);

/// A new group or file without times in it: the same seed gives the same file.
Handle create_group(hid_t parent, const char* name);
Handle create_file(const std::string& path, hid_t access);

/// A new file in memory, in the form of HDF5 1.8, which every reader knows: no fault of a disk reaches HDF5.
Handle create_memory_file(const std::string& name);
/// Its bytes; empty on a fault.
std::string memory_of(const Handle& file);

/// Whether a dataset lies in its own file, and no chunk of it is larger than 64 MiB.
bool is_stored_plainly(hid_t dataset);

/// Writes a new dataset of `shape`; false on a fault.
bool write_array(hid_t group, const char* name, hid_t file_type, hid_t memory_type, const void* values,
                 const std::vector<hsize_t>& shape);

}  // namespace lodestone::data
