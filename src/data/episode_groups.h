#pragma once

#include <string>
#include <vector>

#include "array_reader.h"
#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// Episodes as files up to version 2 hold them: a group `episode_0`, `episode_1`, ... for each, with datasets
/// `observations` [T+1, S], `actions` [T, A], `terminations` [T], `truncations` [T] and `infos/zero_current`
/// [T+1] (of version 1: [T]); its attribute `checksum` is absent in version 1. `others`: groups that are no
/// episode. Throws DataError that begins with `place`.
std::vector<Episode> read_episode_groups(hid_t group, hsize_t others, const RowLayout& layout,
                                         ArrayReader& reader, const std::string& place);

}  // namespace lodestone::data
