#include "lodestone/data/dataset_file.h"

#include <filesystem>
#include <sstream>

#include "hdf5_handle.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "lodestone/common/shown.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/data/episode_bytes.h"
#include "lodestone/data/journal.h"

namespace lodestone::data {
namespace {

using common::DataError;
using common::IoError;

constexpr const char* kFormat = "lodestone-transitions";
/// Version 1 had no row of infos for the reset, and no checksums.
constexpr std::int64_t kFormatVersion = 2;
constexpr const char* kImpossible = "impossible";
constexpr const char* kChecksum = "checksum";
constexpr const char* kPlacements = "placements";
constexpr std::size_t kImageStep = 1 << 20;  // bytes by which the image of a file grows

std::string because(const std::string& detail) { return detail.empty() ? "" : " (" + detail + ")"; }

Handle open_group(hid_t parent, const std::string& name) {
  return Handle(H5Gopen2(parent, name.c_str(), within_file(H5P_GROUP_ACCESS).get()), H5Gclose);
}

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

bool write_info(hid_t root, const DatasetInfo& info) {
  const common::Json json = info_to_json(info);
  bool written =
      write_attribute(root, "format", std::string(kFormat)) &&
      write_attribute(root, "format_version", kFormatVersion) &&
      write_attribute(root, "observation_columns",
                      std::string(info.layout == StateLayout::kPose ? "x_m,y_m,heading_rad" : "x_m,y_m")) &&
      write_attribute(root, "action_columns", std::string("drive_x,drive_y"));
  for (const auto& [name, value] : json.items()) written = written && write_value(root, name.c_str(), value);
  return written;
}

[[noreturn]] void fail_without(const std::string& name, const std::string& path) {
  throw DataError(path + ": attribute '" + name +
                  "' is missing or of another type: this is not a dataset written by lodestone");
}

void check_version(hid_t root, const std::string& path) {
  std::string format;
  std::int64_t version = 0;
  if (!read_attribute(root, "format", format)) fail_without("format", path);
  if (!read_attribute(root, "format_version", version)) fail_without("format_version", path);
  if (format != kFormat || version < 1 || version > kFormatVersion)
    throw DataError(path + ": format \"" + common::shown(format) + "\" version " + std::to_string(version) +
                    "; this program reads \"" + kFormat + "\" up to version " +
                    std::to_string(kFormatVersion));
}

DatasetInfo read_info(hid_t root, const std::string& path) {
  common::Json json = info_to_json(DatasetInfo());
  for (auto& [name, value] : json.items())
    if (!read_value(root, name.c_str(), value, path)) fail_without(name, path);
  return info_from_json(json, path);
}

/// Bytes that a file may still ask for. No recording shrinks to a 64th of its numbers; a shape alone, or
/// links to one array from everywhere, ask for as much as they like.
struct ReadBudget {
  hsize_t bytes;
};
constexpr hsize_t kBytesPerByte = 64;

/// Reads a dataset of an episode and returns its number of rows.
template <class Value>
std::size_t read_array(hid_t group, const char* name, hid_t memory_type, hsize_t columns,
                       std::vector<Value>& values, ReadBudget& budget, const std::string& place) {
  const Handle dataset(H5Dopen2(group, name, within_file(H5P_DATASET_ACCESS).get()), H5Dclose);
  if (!dataset.valid()) throw DataError(place + ": dataset '" + name + "' is missing or damaged");
  const Handle space(H5Dget_space(dataset.get()), H5Sclose);
  hsize_t shape[2] = {0, 1};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank != (columns > 1 ? 2 : 1) || H5Sget_simple_extent_dims(space.get(), shape, nullptr) != rank ||
      shape[1] != columns)
    throw DataError(place + ": dataset '" + name + "' has another shape than [rows, " +
                    std::to_string(columns) + "]");
  if (!is_stored_plainly(dataset.get()))
    throw DataError(place + ": dataset '" + name +
                    "' lies in other files, or in chunks of more than 64 MiB: copy it with h5repack");
  if (shape[0] > budget.bytes / (columns * sizeof(Value)))
    throw DataError(place + ": dataset '" + name + "' asks for " + std::to_string(shape[0]) +
                    " rows, more than the file can hold");
  budget.bytes -= shape[0] * columns * sizeof(Value);
  values.resize(shape[0] * columns);
  if (!values.empty() &&
      H5Dread(dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw DataError(place + ": dataset '" + name + "' cannot be read" + because(last_hdf5_error()));
  return shape[0];
}

/// Throws DataError when the episode is not the one that was written.
void compare_checksum(hid_t group, const Episode& episode, const std::string& place) {
  std::string expected;
  if (!read_attribute(group, kChecksum, expected)) return;  // of version 1
  if (checksum(to_bytes(episode)) != expected)
    throw DataError(place +
                    ": its checksum is not that of its numbers: the file is damaged; take it from a backup");
}

Episode read_episode(hid_t root, const std::string& name, StateLayout layout, ReadBudget& budget,
                     const std::string& path) {
  const std::string place = path + ": " + name;
  const Handle group = open_group(root, name);
  if (!group.valid()) throw DataError(place + " cannot be opened" + because(last_hdf5_error()));
  Episode episode;
  const auto s = static_cast<hsize_t>(state_size(layout));
  const std::size_t rows =
      read_array(group.get(), "observations", H5T_NATIVE_DOUBLE, s, episode.observations, budget, place);
  const std::size_t steps =
      read_array(group.get(), "actions", H5T_NATIVE_DOUBLE, kActionSize, episode.actions, budget, place);
  read_array(group.get(), "terminations", H5T_NATIVE_UINT8, 1, episode.terminations, budget, place);
  read_array(group.get(), "truncations", H5T_NATIVE_UINT8, 1, episode.truncations, budget, place);
  read_array(group.get(), "infos/zero_current", H5T_NATIVE_UINT8, 1, episode.zero_current, budget, place);
  if (rows == steps + 1 && episode.zero_current.size() == rows)
    episode.zero_current.erase(episode.zero_current.begin());  // the reset's
  if (rows != steps + 1 || episode.terminations.size() != steps || episode.truncations.size() != steps ||
      episode.zero_current.size() != steps)
    throw DataError(place + ": " + std::to_string(rows) + " observations do not fit " +
                    std::to_string(steps) +
                    " actions: T actions need T+1 observations and T flags of each kind");
  read_attribute(group.get(), kPlacements, episode.placements);  // absent where nobody counted them
  compare_checksum(group.get(), episode, place);
  return episode;
}

Handle open_file(const std::string& path) {
  silence_hdf5();
  if (!std::filesystem::exists(path))
    throw DataError("cannot read dataset " + path + ": there is no such file");
  common::check_is_file(path);
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.valid())
    throw DataError("cannot open dataset " + path + ": not an HDF5 file, or cut short or damaged" +
                    because(last_hdf5_error()));
  return file;
}

std::string episode_name(std::int64_t index) { return "episode_" + std::to_string(index); }

/// The episodes of a group, in order. `others`: groups in it that are none.
std::vector<Episode> read_episodes(hid_t group, hsize_t others, StateLayout layout, ReadBudget& budget,
                                   const std::string& path) {
  H5G_info_t links{};
  if (H5Gget_info(group, &links) < 0) throw DataError(path + ": its list of episodes is damaged");
  std::vector<Episode> episodes;
  for (hsize_t i = 0; i < links.nlinks - others; ++i) {
    const std::string name = episode_name(static_cast<std::int64_t>(i));
    if (H5Lexists(group, name.c_str(), H5P_DEFAULT) <= 0)
      throw DataError(path + ": holds " + std::to_string(links.nlinks - others) + " groups, but " + name +
                      " is missing");
    episodes.push_back(read_episode(group, name, layout, budget, path));
  }
  return episodes;
}

bool write_episode(hid_t parent, std::int64_t index, const Episode& episode, StateLayout layout) {
  const auto steps = static_cast<hsize_t>(episode.length());
  const auto s = static_cast<hsize_t>(state_size(layout));
  const std::vector<double> rewards(steps, 0.0);
  std::vector<std::uint8_t> zero_current = episode.zero_current;
  zero_current.insert(zero_current.begin(), 0);  // infos have a row for the reset, too
  const Handle group = create_group(parent, episode_name(index).c_str());
  const Handle infos = create_group(group.get(), "infos");
  const auto numbers = [&](const char* key, const std::vector<double>& values, std::vector<hsize_t> shape) {
    return write_array(group.get(), key, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), shape);
  };
  const auto flags = [&](hid_t in, const char* key, const std::vector<std::uint8_t>& values) {
    return write_array(in, key, H5T_STD_U8LE, H5T_NATIVE_UINT8, values.data(), {values.size()});
  };
  return group.valid() && infos.valid() && write_attribute(group.get(), "id", index) &&
         write_attribute(group.get(), "total_steps", episode.length()) &&
         write_attribute(group.get(), kPlacements, episode.placements) &&
         write_attribute(group.get(), kChecksum, checksum(to_bytes(episode))) &&
         numbers("observations", episode.observations, {steps + 1, s}) &&
         numbers("actions", episode.actions, {steps, kActionSize}) && numbers("rewards", rewards, {steps}) &&
         flags(group.get(), "terminations", episode.terminations) &&
         flags(group.get(), "truncations", episode.truncations) &&
         flags(infos.get(), "zero_current", zero_current);
}

bool write_episodes(hid_t parent, const std::vector<Episode>& episodes, StateLayout layout) {
  for (std::size_t i = 0; i < episodes.size(); ++i)
    if (!write_episode(parent, static_cast<std::int64_t>(i), episodes[i], layout)) return false;
  return true;
}

bool write_all(hid_t root, const Dataset& dataset) {
  if (!write_info(root, dataset.info) ||
      !write_attribute(root, "total_episodes", static_cast<std::int64_t>(dataset.episodes.size())) ||
      !write_attribute(root, "total_steps", dataset.transitions()) ||
      !write_episodes(root, dataset.episodes, dataset.info.layout))
    return false;
  if (dataset.impossible.empty()) return true;
  const Handle group = create_group(root, kImpossible);
  return group.valid() && write_episodes(group.get(), dataset.impossible, dataset.info.layout);
}

/// The bytes of a file with this dataset. HDF5 makes them in memory, so that no fault of a disk reaches it.
std::string file_image(const Dataset& dataset, const std::string& path) {
  silence_hdf5();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), kImageStep, false);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18);  // what every reader knows
  const Handle file = create_file(path, access.get());
  if (file.valid() && write_all(file.get(), dataset) && H5Fflush(file.get(), H5F_SCOPE_LOCAL) >= 0) {
    // From the memory itself: H5Fget_file_image leaves a superblock of this version without its checksum.
    void* memory = nullptr;
    const ssize_t size = H5Fget_file_image(file.get(), nullptr, 0);
    if (size > 0 && H5Fget_vfd_handle(file.get(), H5P_DEFAULT, &memory) >= 0)
      return {*static_cast<char**>(memory), static_cast<std::size_t>(size)};
  }
  throw IoError("cannot make dataset " + path + ": HDF5 reports a fault" + because(last_hdf5_error()));
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
  check_version(file.get(), path);
  dataset.info = read_info(file.get(), path);
  ReadBudget budget{kBytesPerByte * std::filesystem::file_size(path)};
  const bool glitches = H5Lexists(file.get(), kImpossible, H5P_DEFAULT) > 0;
  dataset.episodes = read_episodes(file.get(), glitches ? 1 : 0, dataset.info.layout, budget, path);
  if (glitches)
    dataset.impossible = read_episodes(open_group(file.get(), kImpossible).get(), 0, dataset.info.layout,
                                       budget, path + ": impossible");
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
    if (part.info.layout != all.info.layout || part.info.action_unit != all.info.action_unit ||
        part.info.action_scale != all.info.action_scale ||
        part.info.control_period_s != all.info.control_period_s)
      throw DataError(
          path + ": state, unit or scale of the actions, or period differ from the recordings before it in " +
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
