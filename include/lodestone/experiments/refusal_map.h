#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lodestone/control/pose_sensor.h"
#include "lodestone/runs/qualification_result.h"

namespace lodestone::experiments {

/// Looks, and those of them that gave no pose.
struct LookCount {
  std::int64_t looks = 0, refused = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("looks", looks);
    v.field("refused", refused);
  }
};

/// What a RefusalMap has counted, and goes on from.
struct RefusalCounts {
  LookCount all;
  std::int64_t waiting = 0;                       ///< looks without a pose since the last one with it
  std::map<int, std::map<int, LookCount>> cells;  ///< squares of the dish, by column (along x) and row
  std::vector<LookCount> headings;                ///< bins all around
  std::map<std::string, std::int64_t> reasons;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("all", all);
    v.field("waiting", waiting);
    v.field("cells", cells);
    v.field("headings", headings);
    v.field("reasons", reasons);
  }
};

/// Where, and at which headings, looks gave no pose. Without a pulse the needle lies still: a look that gave
/// none counts where the needle is seen next.
class RefusalMap {
 public:
  explicit RefusalMap(double dish_radius_m);

  void add(const control::PoseEstimate& estimate);
  runs::RefusalFigures figures() const;

  const RefusalCounts& counts() const { return counts_; }
  /// Goes on from there. Throws DataError where they are of other bins.
  void restore(RefusalCounts counts);

 private:
  double radius_m_;
  RefusalCounts counts_;
};

}  // namespace lodestone::experiments
