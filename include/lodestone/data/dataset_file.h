#pragma once

#include <string>

#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// HDF5 with all episodes as one batch, one behind the other: datasets `steps` and `placements` [E],
/// `checksums` [E, 32], `observations` [N+E, S] (of each episode one more than steps), `actions` [N, A],
/// `terminations`, `truncations` and `zero_current` [N]; attributes on the root name layout, units, scales,
/// seed and rig parameters (JSON). Recorded steps that cannot be lie in a group `impossible` of the same
/// form, where there are any. Files of earlier versions, with a group for each episode, are read, too.

/// What a run records is in this file of its folder.
constexpr const char* kRecordingFile = "transitions.h5";

/// Reads `.h5` whole; throws DataError (not HDF5, missing group, wrong shape, NaN, wrong checksum: says
/// where). Where a journal lies beside it, the recording is unfinished, and what the journal holds is read.
Dataset read_dataset(const std::string& path);

/// Reads .h5, or .csv through the importers (aborting on the first bad row).
Dataset read_any_dataset(const std::string& path);

/// Several of one rig, separated by commas, as one dataset. Throws DataError when they do not fit together.
Dataset read_recordings(const std::string& paths);

/// `path` then holds all of it, or what it held before. Throws IoError, and DataError where a journal beside
/// it would be read in its place.
void write_dataset(const std::string& path, const Dataset& dataset);

/// The end of a recording: the journal beside `path` becomes the dataset `path`, and is gone. A kill at any
/// point is no loss; without a journal nothing happens.
void fold_journal(const std::string& path);

/// The other way: makes the journal of a dataset, to go on with the recording. Nothing where there is a
/// journal, or no dataset.
void unfold_dataset(const std::string& path);

}  // namespace lodestone::data
