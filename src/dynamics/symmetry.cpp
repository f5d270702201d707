#include "symmetry.h"

#include <ATen/TensorOperators.h>
#include <ATen/ops/cat.h>

#include "lodestone/dynamics/network.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::dynamics {
namespace {

constexpr int kQuarters = 4;

}  // namespace

int ways_of(Symmetry symmetry) { return symmetry == Symmetry::kSquare ? 2 * kQuarters : 1; }

at::Tensor seen(const at::Tensor& rows, int way) {
  if (way == 0) return rows;
  const bool mirrored = way >= kQuarters;
  const int quarters = way % kQuarters;
  at::Tensor x = rows.narrow(1, 0, 1);
  at::Tensor y = rows.narrow(1, 1, 1);
  if (mirrored) y = -y;
  for (int k = 0; k < quarters; ++k) {
    const at::Tensor was_x = x;
    x = -y;
    y = was_x;
  }
  if (rows.size(1) == 2) return at::cat({x, y}, 1);
  const at::Tensor heading = rows.narrow(1, 2, 1);
  return at::cat({x, y, wrap_angles((mirrored ? -heading : heading) + 0.5 * geometry::kPi * quarters)}, 1);
}

}  // namespace lodestone::dynamics
