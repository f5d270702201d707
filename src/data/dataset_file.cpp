#include "lodestone/data/dataset_file.h"

#include <fcntl.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "hdf5_handle.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shown.h"
#include "lodestone/data/csv_import.h"

namespace lodestone::data {
namespace {

using common::DataError;
using common::IoError;

constexpr const char* kFormat = "lodestone-transitions";
constexpr std::int64_t kFormatVersion = 1;
constexpr const char* kImpossible = "impossible";
// Room for the object headers and index nodes of one episode beside its numbers.
constexpr std::int64_t kMetadataBytes = 64 * 1024;
constexpr std::int64_t kReserveAhead = 1024 * 1024;

std::string because(const std::string& detail) { return detail.empty() ? "" : " (" + detail + ")"; }

Handle file_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // 1.8's format: it has no "open for writing" mark, which a killed run would leave behind, locking the file.
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18);
  return access;
}

Handle open_group(hid_t parent, const std::string& name) {
  return Handle(H5Gopen2(parent, name.c_str(), within_file(H5P_GROUP_ACCESS).get()), H5Gclose);
}

bool write_info(hid_t root, const DatasetInfo& info) {
  const bool pose = info.layout == StateLayout::kPose;
  return write_attribute(root, "format", std::string(kFormat)) &&
         write_attribute(root, "format_version", kFormatVersion) &&
         write_attribute(root, "layout", std::string(pose ? "pose" : "position")) &&
         write_attribute(root, "observation_columns",
                         std::string(pose ? "x_m,y_m,heading_rad" : "x_m,y_m")) &&
         write_attribute(root, "action_columns", std::string("drive_x,drive_y")) &&
         write_attribute(root, "action_unit", info.action_unit) &&
         write_attribute(root, "action_scale", info.action_scale) &&
         write_attribute(root, "workspace_radius_m", info.workspace_radius_m) &&
         write_attribute(root, "one_axis_at_a_time", std::int64_t{info.one_axis_at_a_time}) &&
         write_attribute(root, "control_period_s", info.control_period_s) &&
         write_attribute(root, "seed", info.seed) && write_attribute(root, "source", info.source) &&
         write_attribute(root, "rig", info.rig.dump());
}

template <class Value>
void require(hid_t root, const char* name, Value& value, const std::string& path) {
  if (!read_attribute(root, name, value))
    throw DataError(path + ": attribute '" + name +
                    "' is missing or of another type: this is not a dataset written by lodestone");
}

DatasetInfo read_info(hid_t root, const std::string& path) {
  std::string format;
  std::int64_t version = 0;
  require(root, "format", format, path);
  require(root, "format_version", version, path);
  if (format != kFormat || version != kFormatVersion)
    throw DataError(path + ": format \"" + common::shown(format) + "\" version " + std::to_string(version) +
                    "; this program reads \"" + kFormat + "\" version " + std::to_string(kFormatVersion));
  DatasetInfo info;
  std::string layout;
  std::string rig;
  std::int64_t one_axis = 0;
  require(root, "layout", layout, path);
  if (layout != "pose" && layout != "position")
    throw DataError(path + ": layout \"" + common::shown(layout) + "\" must be pose or position");
  info.layout = layout == "pose" ? StateLayout::kPose : StateLayout::kPosition;
  require(root, "action_unit", info.action_unit, path);
  require(root, "action_scale", info.action_scale, path);
  require(root, "workspace_radius_m", info.workspace_radius_m, path);
  require(root, "one_axis_at_a_time", one_axis, path);
  info.one_axis_at_a_time = one_axis != 0;
  require(root, "control_period_s", info.control_period_s, path);
  require(root, "seed", info.seed, path);
  require(root, "source", info.source, path);
  require(root, "rig", rig, path);
  info.rig = common::parse_json(rig, path + ": attribute 'rig'");
  return info;
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
  if (rows != steps + 1 || episode.terminations.size() != steps || episode.truncations.size() != steps ||
      episode.zero_current.size() != steps)
    throw DataError(place + ": " + std::to_string(rows) + " observations do not fit " +
                    std::to_string(steps) +
                    " actions: T actions need T+1 observations and T flags of each kind");
  return episode;
}

Handle open_file(const std::string& path, unsigned mode) {
  silence_hdf5();
  if (!std::filesystem::exists(path))
    throw DataError("cannot read dataset " + path + ": there is no such file");
  common::check_is_file(path);
  const Handle access = file_access();
  Handle file(H5Fopen(path.c_str(), mode, access.get()), H5Fclose);
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

bool write_episode(hid_t parent, const std::string& name, const Episode& episode, StateLayout layout) {
  const auto steps = static_cast<hsize_t>(episode.length());
  const auto s = static_cast<hsize_t>(state_size(layout));
  const std::vector<double> rewards(steps, 0.0);
  const Handle group(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const Handle infos(H5Gcreate2(group.get(), "infos", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const auto numbers = [&](const char* key, const std::vector<double>& values, std::vector<hsize_t> shape) {
    return write_array(group.get(), key, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), shape);
  };
  const auto flags = [&](hid_t in, const char* key, const std::vector<std::uint8_t>& values) {
    return write_array(in, key, H5T_STD_U8LE, H5T_NATIVE_UINT8, values.data(), {steps});
  };
  return group.valid() && infos.valid() && numbers("observations", episode.observations, {steps + 1, s}) &&
         numbers("actions", episode.actions, {steps, kActionSize}) && numbers("rewards", rewards, {steps}) &&
         flags(group.get(), "terminations", episode.terminations) &&
         flags(group.get(), "truncations", episode.truncations) &&
         flags(infos.get(), "zero_current", episode.zero_current);
}

bool ends_with(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace

Dataset read_dataset(const std::string& path) {
  const Handle file = open_file(path, H5F_ACC_RDONLY);
  Dataset dataset;
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

struct DatasetWriter::State {
  std::string path;
  DatasetInfo info;
  Handle file;
  std::int64_t episodes = 0;
  std::int64_t transitions = 0;
  std::int64_t reserved = 0;  // the disk space up to this byte is ours
  bool flush_each = true;

  [[noreturn]] void fail(const std::string& detail) const {
    throw IoError("cannot write episode " + std::to_string(episodes) + " to " + path + ": " + detail +
                  "; the episodes before it are kept");
  }

  /// Claims disk space for an episode before HDF5 touches the file, so that a full disk cannot leave it
  /// half-updated. Claims more than asked for while there is plenty: it costs as much as a small write.
  void reserve(std::int64_t bytes) {
    void* handle = nullptr;
    hsize_t size = 0;
    if (H5Fget_vfd_handle(file.get(), H5P_DEFAULT, &handle) < 0 || H5Fget_filesize(file.get(), &size) < 0)
      fail("the file is not open" + because(last_hdf5_error()));
    const auto used = static_cast<std::int64_t>(size);
    if (used + bytes <= reserved) return;
    const int descriptor = *static_cast<int*>(handle);
    int error = posix_fallocate(descriptor, used, bytes + kReserveAhead);
    const bool ahead = error == 0;
    if (!ahead) error = posix_fallocate(descriptor, used, bytes);
    if (error != 0 && error != EOPNOTSUPP && error != EINVAL) fail(std::strerror(error));
    reserved = used + bytes + (ahead ? kReserveAhead : 0);
  }

  /// Gives back what was claimed and not used.
  void close_file() noexcept {
    hsize_t used = 0;
    const bool known =
        file.valid() && H5Fflush(file.get(), H5F_SCOPE_LOCAL) >= 0 && H5Fget_filesize(file.get(), &used) >= 0;
    file.reset();
    std::error_code ignored;
    if (known && std::filesystem::file_size(path, ignored) > used)
      std::filesystem::resize_file(path, used, ignored);
  }
};

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

DatasetWriter::DatasetWriter(const std::string& path, const DatasetInfo& info, bool append)
    : state_(std::make_unique<State>()) {
  silence_hdf5();
  state_->path = path;
  state_->info = info;
  if (append && std::filesystem::exists(path)) {
    state_->file = open_file(path, H5F_ACC_RDWR);
    if (read_info(state_->file.get(), path).layout != info.layout)
      throw DataError(path + ": holds another state layout than the episodes to append");
    if (!read_attribute(state_->file.get(), "total_episodes", state_->episodes) ||
        !read_attribute(state_->file.get(), "total_steps", state_->transitions))
      throw DataError(path + ": attributes total_episodes and total_steps are missing: cannot append");
    return;
  }
  const Handle access = file_access();
  state_->file = Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  if (!state_->file.valid())
    throw IoError("cannot create dataset " + path + because(last_hdf5_error()) +
                  ": check that the folder exists and can be written to");
  const hid_t root = state_->file.get();
  state_->reserve(kMetadataBytes);
  if (!write_info(root, info) || !write_attribute(root, "total_episodes", std::int64_t{0}) ||
      !write_attribute(root, "total_steps", std::int64_t{0}) || H5Fflush(root, H5F_SCOPE_LOCAL) < 0)
    throw IoError("cannot write to dataset " + path + because(last_hdf5_error()));
}

DatasetWriter::~DatasetWriter() { state_->close_file(); }

void DatasetWriter::write(const Episode& episode) {
  Dataset one;
  one.info = state_->info;
  one.episodes = {episode};
  check_dataset(one, state_->path + ", episode " + std::to_string(state_->episodes) + " to be written");

  const hid_t root = state_->file.get();
  const auto steps = static_cast<hsize_t>(episode.length());
  const auto s = static_cast<hsize_t>(state_size(state_->info.layout));
  state_->reserve(static_cast<std::int64_t>(steps * (8 * s + 8 * kActionSize + 8 + 3)) + kMetadataBytes);

  const bool written = write_episode(root, episode_name(state_->episodes), episode, state_->info.layout) &&
                       write_attribute(root, "total_episodes", state_->episodes + 1) &&
                       write_attribute(root, "total_steps", state_->transitions + episode.length()) &&
                       (!state_->flush_each || H5Fflush(root, H5F_SCOPE_LOCAL) >= 0);
  if (!written) state_->fail("HDF5 reports a fault" + because(last_hdf5_error()));
  ++state_->episodes;
  state_->transitions += episode.length();
}

void DatasetWriter::write_impossible(const std::vector<Episode>& steps) {
  const hid_t root = state_->file.get();
  state_->reserve(static_cast<std::int64_t>(steps.size() + 1) * kMetadataBytes);
  const Handle group(H5Gcreate2(root, kImpossible, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  bool written = group.valid();
  for (std::size_t i = 0; written && i < steps.size(); ++i)
    written =
        write_episode(group.get(), episode_name(static_cast<std::int64_t>(i)), steps[i], state_->info.layout);
  if (!written) state_->fail("HDF5 reports a fault" + because(last_hdf5_error()));
}

void DatasetWriter::set_flush_each(bool flush_each) { state_->flush_each = flush_each; }

void DatasetWriter::flush() {
  if (H5Fflush(state_->file.get(), H5F_SCOPE_LOCAL) < 0)
    state_->fail("HDF5 reports a fault" + because(last_hdf5_error()));
}

std::int64_t DatasetWriter::episodes() const { return state_->episodes; }
std::int64_t DatasetWriter::transitions() const { return state_->transitions; }

void write_dataset(const std::string& path, const Dataset& dataset) {
  const std::string part = path + ".part";
  try {
    {
      DatasetWriter writer(part, dataset.info);
      writer.set_flush_each(false);
      for (const Episode& episode : dataset.episodes) writer.write(episode);
      if (!dataset.impossible.empty()) writer.write_impossible(dataset.impossible);
      writer.flush();
    }
    common::sync_path(part);
    std::error_code fault;
    std::filesystem::rename(part, path, fault);
    if (fault) throw IoError("cannot write dataset " + path + ": " + fault.message());
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw;
  }
}

}  // namespace lodestone::data
