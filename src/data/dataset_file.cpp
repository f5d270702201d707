#include "lodestone/data/dataset_file.h"

#include <filesystem>
#include <sstream>

#include "array_reader.h"
#include "episode_batch.h"
#include "episode_groups.h"
#include "hdf5_handle.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "lodestone/common/shown.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/data/journal.h"

namespace lodestone::data {
namespace {

using common::DataError;
using common::IoError;

constexpr const char* kFormat = "lodestone-transitions";
/// Up to version 2 every episode was a group of its own.
constexpr std::int64_t kFormatVersion = 3;
constexpr std::int64_t kLastWithGroups = 2;
constexpr const char* kImpossible = "impossible";

bool write_value(hid_t root, const char* name, const common::Json& value) {
  if (value.is_string()) return write_attribute(root, name, value.get<std::string>());
  if (value.is_boolean()) return write_attribute(root, name, std::int64_t{value.get<bool>()});
  if (value.is_number_integer()) return write_attribute(root, name, value.get<std::int64_t>());
  if (value.is_number()) return write_attribute(root, name, value.get<double>());
  return write_attribute(root, name, value.dump());
}

/// The attribute as a value of the type that `value` has.
bool read_value(hid_t root, const char* name, common::Json& value, const std::string& path) {
  std::string text;
  std::int64_t whole = 0;
  double number = 0.0;
  bool found = false;
  if (value.is_boolean() || value.is_number_integer()) {
    found = read_attribute(root, name, whole);
    value = value.is_boolean() ? common::Json(whole != 0) : common::Json(whole);
  } else if (value.is_number()) {
    found = read_attribute(root, name, number);
    value = number;
  } else if (value.is_string()) {
    found = read_attribute(root, name, text);
    value = text;
  } else {
    found = read_attribute(root, name, text);
    if (found) value = common::parse_json(text, path + ": attribute '" + name + "'");
  }
  return found;
}

std::string action_columns(int action_size) {
  std::string columns = action_column(0, action_size);
  for (int i = 1; i < action_size; ++i) columns += "," + action_column(i, action_size);
  return columns;
}

bool write_info(hid_t root, const DatasetInfo& info) {
  const common::Json json = info_to_json(info);
  bool written =
      write_attribute(root, "format", std::string(kFormat)) &&
      write_attribute(root, "format_version", kFormatVersion) &&
      write_attribute(root, "observation_columns",
                      std::string(info.layout == StateLayout::kPose ? "x_m,y_m,heading_rad" : "x_m,y_m")) &&
      write_attribute(root, "action_columns", action_columns(info.action_size));
  for (const auto& [name, value] : json.items()) written = written && write_value(root, name.c_str(), value);
  return written;
}

[[noreturn]] void fail_without(const std::string& name, const std::string& path) {
  throw DataError(path + ": attribute '" + name +
                  "' is missing or of another type: this is not a dataset written by lodestone");
}

/// Throws DataError where this program cannot read it.
std::int64_t version_of(hid_t root, const std::string& path) {
  std::string format;
  std::int64_t version = 0;
  if (!read_attribute(root, "format", format)) fail_without("format", path);
  if (!read_attribute(root, "format_version", version)) fail_without("format_version", path);
  if (format != kFormat || version < 1 || version > kFormatVersion)
    throw DataError(path + ": format \"" + common::shown(format) + "\" version " + std::to_string(version) +
                    "; this program reads \"" + kFormat + "\" up to version " +
                    std::to_string(kFormatVersion));
  return version;
}

/// The attribute that files from before there were other drives do not have.
constexpr const char* kLater = "action_size";

DatasetInfo read_info(hid_t root, const std::string& path) {
  common::Json json = info_to_json(DatasetInfo());
  for (auto& [name, value] : json.items()) {
    if (name == kLater && H5Aexists(root, kLater) == 0) continue;  // it stays what it means then
    if (!read_value(root, name.c_str(), value, path)) fail_without(name, path);
  }
  return info_from_json(json, path);
}

Handle open_file(const std::string& path) {
  silence_hdf5();
  if (!std::filesystem::exists(path))
    throw DataError("cannot read dataset " + path + ": there is no such file");
  common::check_is_file(path);
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.valid())
    throw DataError("cannot open dataset " + path + ": not an HDF5 file, or cut short or damaged" +
                    because_of_hdf5());
  return file;
}

bool write_all(hid_t root, const Dataset& dataset) {
  if (!write_info(root, dataset.info) ||
      !write_attribute(root, "total_episodes", static_cast<std::int64_t>(dataset.episodes.size())) ||
      !write_attribute(root, "total_steps", dataset.transitions()) ||
      !write_episode_batch(root, dataset.episodes, dataset.info.rows()))
    return false;
  if (dataset.impossible.empty()) return true;
  const Handle group = create_group(root, kImpossible);
  return group.valid() && write_episode_batch(group.get(), dataset.impossible, dataset.info.rows());
}

/// The bytes of a file with this dataset.
std::string file_image(const Dataset& dataset, const std::string& path) {
  silence_hdf5();
  const Handle file = create_memory_file(path);
  std::string image;
  if (file.valid() && write_all(file.get(), dataset)) image = memory_of(file);
  if (image.empty())
    throw IoError("cannot make dataset " + path + ": HDF5 reports a fault" + because_of_hdf5());
  return image;
}

bool ends_with(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

void put_dataset(const std::string& path, const Dataset& dataset) {
  check_dataset(dataset, path + " to be written");
  common::write_file_atomically(path, file_image(dataset, path));
}

}  // namespace

Dataset read_dataset(const std::string& path) {
  Dataset dataset;
  const std::string journal = journal_beside(path);
  if (std::filesystem::exists(journal)) {
    JournalContent content = read_journal(journal);
    dataset.info = std::move(content.info);
    dataset.episodes = std::move(content.episodes);
    check_dataset(dataset, journal);
    return dataset;
  }
  const Handle file = open_file(path);
  const bool groups = version_of(file.get(), path) <= kLastWithGroups;
  dataset.info = read_info(file.get(), path);
  ArrayReader reader(std::filesystem::file_size(path));
  const bool glitches = H5Lexists(file.get(), kImpossible, H5P_DEFAULT) > 0;
  const auto read = [&](hid_t group, hsize_t others, const std::string& place) {
    return groups ? read_episode_groups(group, others, dataset.info.rows(), reader, place)
                  : read_episode_batch(group, dataset.info.rows(), reader, place);
  };
  dataset.episodes = read(file.get(), glitches ? 1 : 0, path);
  if (glitches)
    dataset.impossible = read(open_group(file.get(), kImpossible).get(), 0, path + ": impossible");
  check_dataset(dataset, path);
  return dataset;
}

Dataset read_any_dataset(const std::string& path) {
  if (ends_with(path, ".csv") || ends_with(path, ".CSV")) return import_csv(path, CsvImportConfig{}).dataset;
  return read_dataset(path);
}

Dataset read_recordings(const std::string& paths) {
  Dataset all;
  std::istringstream names(paths);
  bool first = true;
  for (std::string path; std::getline(names, path, ',');) {
    Dataset part = read_any_dataset(path);
    if (first) {
      all = std::move(part);
      first = false;
      continue;
    }
    if (part.info.layout != all.info.layout || part.info.action_size != all.info.action_size ||
        part.info.action_unit != all.info.action_unit || part.info.action_scale != all.info.action_scale ||
        part.info.control_period_s != all.info.control_period_s)
      throw DataError(
          path +
          ": state, size, unit or scale of the actions, or period differ from the recordings before it in " +
          paths);
    all.info.one_axis_at_a_time = all.info.one_axis_at_a_time && part.info.one_axis_at_a_time;
    all.info.source += ", " + part.info.source;
    for (Episode& episode : part.episodes) all.episodes.push_back(std::move(episode));
    for (Episode& step : part.impossible) all.impossible.push_back(std::move(step));
  }
  return all;
}

void write_dataset(const std::string& path, const Dataset& dataset) {
  if (const std::string journal = journal_beside(path); std::filesystem::exists(journal))
    throw DataError(path + " is not written: beside it lies " + journal +
                    ", an unfinished recording that is read in its place; finish that one, move it, or name "
                    "another file");
  put_dataset(path, dataset);
}

void fold_journal(const std::string& path) {
  const std::string journal = journal_beside(path);
  if (!std::filesystem::exists(journal)) return;
  put_dataset(path, read_dataset(path));
  common::remove_file(journal);
}

void unfold_dataset(const std::string& path) {
  const std::string journal = journal_beside(path);
  if (std::filesystem::exists(journal) || !std::filesystem::exists(path)) return;
  const Dataset dataset = read_dataset(path);
  const std::string part = journal + ".part";
  common::remove_file(part);
  JournalWriter writer(part, dataset.info, AfterDamage::kRefuse);
  for (const Episode& episode : dataset.episodes) writer.write(episode);
  writer.sync();
  common::replace_file(part, journal);
}

}  // namespace lodestone::data
