#pragma once

#include <memory>
#include <string>

#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// HDF5 in Minari's layout: groups `episode_0`, `episode_1`, ... with datasets `observations` [T+1, S],
/// `actions` [T, 2], `rewards` [T] (zero: rewards are computed at training), `terminations` [T],
/// `truncations` [T] and `infos/zero_current` [T]; attributes on the root name layout, units, scales, seed
/// and rig parameters (JSON). Recorded steps that cannot be lie in a group `impossible` of the same form,
/// where there are any.

/// Reads `.h5` whole; throws DataError (not HDF5, missing group, wrong shape, NaN: says where).
Dataset read_dataset(const std::string& path);

/// Reads .h5, or .csv through the importers (aborting on the first bad row).
Dataset read_any_dataset(const std::string& path);

/// Several of one rig, separated by commas, as one dataset. Throws DataError when they do not fit together.
Dataset read_recordings(const std::string& paths);

/// Writes one episode at a time and flushes after each, so that a killed run keeps every finished episode.
class DatasetWriter {
 public:
  /// Creates `path`, or with `append` goes on in it (episodes are numbered on). Throws IoError.
  DatasetWriter(const std::string& path, const DatasetInfo& info, bool append = false);
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  /// Throws IoError when the disk is full; episodes before it stay readable.
  void write(const Episode& episode);
  /// Steps that are no part of the data, once, in a group of their own.
  void write_impossible(const std::vector<Episode>& steps);
  /// False: leave flushing to flush(), when nothing would be lost with the file.
  void set_flush_each(bool flush_each);
  /// Hands everything written to the system. Throws IoError.
  void flush();
  std::int64_t episodes() const;
  std::int64_t transitions() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes a whole dataset under a temporary name and renames it: `path` then holds all of it, or what it held
/// before. Throws IoError or DataError.
void write_dataset(const std::string& path, const Dataset& dataset);

}  // namespace lodestone::data
