#include "lodestone/experiments/refusal_map.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::experiments {
namespace {

constexpr std::size_t kMostReasons = 20;  // some hold numbers
constexpr const char* kOtherReasons = "other reasons";

}  // namespace

void RefusalMap::add(const control::PoseEstimate& estimate) {
  ++all_.looks;
  if (!estimate.valid) {
    ++all_.refused;
    ++waiting_;
    const bool room = reasons_.size() < kMostReasons || reasons_.count(estimate.reason) != 0;
    ++reasons_[room ? estimate.reason : kOtherReasons];
    return;
  }
  const double side_m = 2.0 * radius_m_ / kAcross;
  const auto cell = [&](double at_m) { return static_cast<int>(std::floor((at_m + radius_m_) / side_m)); };
  const double turns =
      (geometry::wrap_angle(estimate.pose.heading_rad) + geometry::kPi) / (2.0 * geometry::kPi);
  const int heading = std::clamp(static_cast<int>(turns * kHeadings), 0, kHeadings - 1);
  for (Count* count : {&cells_[{cell(estimate.pose.x_m), cell(estimate.pose.y_m)}],
                       &headings_[static_cast<std::size_t>(heading)]}) {
    count->looks += 1 + waiting_;
    count->refused += waiting_;
  }
  waiting_ = 0;
}

runs::RefusalFigures RefusalMap::figures() const {
  runs::RefusalFigures figures;
  figures.share.n = all_.looks;
  if (all_.looks > 0) {
    figures.share.value = static_cast<double>(all_.refused) / static_cast<double>(all_.looks);
    const common::Interval interval = common::wilson_interval(all_.refused, all_.looks);
    figures.share.interval = std::array<double, 2>{interval.low, interval.high};
  }
  figures.cell_mm = geometry::kMmPerM * 2.0 * radius_m_ / kAcross;
  figures.heading_bin_deg = 360.0 / kHeadings;
  for (const auto& [at, count] : cells_) {
    runs::RefusalBin bin;
    bin.x_mm = (at.first + 0.5) * figures.cell_mm - geometry::kMmPerM * radius_m_;
    bin.y_mm = (at.second + 0.5) * figures.cell_mm - geometry::kMmPerM * radius_m_;
    bin.looks = count.looks;
    bin.refused = count.refused;
    figures.cells.push_back(bin);
  }
  for (std::size_t i = 0; i < headings_.size(); ++i) {
    runs::RefusalBin bin;
    bin.heading_from_deg = -180.0 + static_cast<double>(i) * figures.heading_bin_deg;
    bin.looks = headings_[i].looks;
    bin.refused = headings_[i].refused;
    figures.headings.push_back(bin);
  }
  figures.reasons = reasons_;
  return figures;
}

}  // namespace lodestone::experiments
