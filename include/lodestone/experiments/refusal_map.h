#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "lodestone/control/pose_sensor.h"
#include "lodestone/runs/qualification_result.h"

namespace lodestone::experiments {

/// Where, and at which headings, looks gave no pose. Without a pulse the needle lies still: a look that gave
/// none counts where the needle is seen next.
class RefusalMap {
 public:
  explicit RefusalMap(double dish_radius_m) : radius_m_(dish_radius_m) {}

  void add(const control::PoseEstimate& estimate);
  runs::RefusalFigures figures() const;

 private:
  static constexpr int kAcross = 10;    ///< cells along a diameter
  static constexpr int kHeadings = 12;  ///< bins around
  struct Count {
    std::int64_t looks = 0, refused = 0;
  };

  double radius_m_;
  Count all_;
  std::int64_t waiting_ = 0;  ///< looks without a pose since the last one with it
  std::map<std::pair<int, int>, Count> cells_;
  std::array<Count, kHeadings> headings_{};
  std::map<std::string, std::int64_t> reasons_;
};

}  // namespace lodestone::experiments
