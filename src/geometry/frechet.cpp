#include "lodestone/geometry/frechet.h"

#include <algorithm>

#include "lodestone/common/error.h"

namespace lodestone::geometry {

double discrete_frechet_m(const std::vector<Vector2>& a_m, const std::vector<Vector2>& b_m) {
  LODESTONE_CHECK(!a_m.empty() && !b_m.empty(), "two polylines with at least one point each");
  std::vector<double> leash_m(b_m.size());  // to come to this point of b with the walker on a where it is
  for (std::size_t i = 0; i < a_m.size(); ++i) {
    double diagonal_m = 0.0;  // the leash one step back on both
    for (std::size_t j = 0; j < b_m.size(); ++j) {
      double way_m = 0.0;  // both walkers stand at their beginning
      if (i > 0 && j > 0)
        way_m = std::min({leash_m[j], leash_m[j - 1], diagonal_m});
      else if (i > 0)
        way_m = leash_m[j];
      else if (j > 0)
        way_m = leash_m[j - 1];
      diagonal_m = leash_m[j];
      leash_m[j] = std::max(way_m, (a_m[i] - b_m[j]).norm());
    }
  }
  return leash_m.back();
}

}  // namespace lodestone::geometry
