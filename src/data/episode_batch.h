#pragma once

#include <string>
#include <vector>

#include "array_reader.h"
#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// Episodes as a file holds them since version 3: all of them in one array of each kind, one behind the
/// other. E episodes of together N steps are `steps` [E], `placements` [E], `checksums` [E, 32] (hex digits),
/// `observations` [N+E, S], `actions` [N, A], `terminations`, `truncations` and `zero_current` [N].

/// False on a fault of HDF5.
bool write_episode_batch(hid_t group, const std::vector<Episode>& episodes, const RowLayout& layout);

/// Throws DataError that begins with `place`.
std::vector<Episode> read_episode_batch(hid_t group, const RowLayout& layout, ArrayReader& reader,
                                        const std::string& place);

}  // namespace lodestone::data
