#pragma once

#include <string>

#include <ATen/core/Tensor.h>

#include "lodestone/data/dataset_info.h"
#include "lodestone/inference/dynamics_config.h"

namespace lodestone::dynamics {

/// What `asked` means for a recording: none or square, of which coils must be alike only where it is `exact`.
/// Throws ConfigError that names `key` where square is asked for, and the recording's rig is not described
/// so, or its drives are not vectors along x and y.
inference::Symmetry symmetry_of(inference::Symmetry asked, bool exact, const data::DatasetInfo& info,
                                const std::string& key);

/// Ways to see a recording that belong to it (data augmentation by the dihedral group of the square), the
/// recording as it is among them: 1, or 8.
int ways_of(inference::Symmetry symmetry);

/// Rows as they look in one of the 8 ways of a square: [N, 2] vectors (positions, or drives along x and y),
/// or [N, 3] poses with the heading wrapped to (-pi, pi]. Way 0 leaves them; the four from 4 on are mirrored
/// at the x axis before they are turned by way % 4 quarters.
at::Tensor seen(const at::Tensor& rows, int way);

}  // namespace lodestone::dynamics
