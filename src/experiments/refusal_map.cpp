#include "lodestone/experiments/refusal_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::experiments {
namespace {

constexpr int kAcross = 10;               // cells along a diameter
constexpr int kHeadings = 12;             // bins around
constexpr std::size_t kMostReasons = 20;  // some hold numbers
constexpr const char* kOtherReasons = "other reasons";

}  // namespace

RefusalMap::RefusalMap(double dish_radius_m) : radius_m_(dish_radius_m) {
  counts_.headings.resize(kHeadings);
}

void RefusalMap::restore(RefusalCounts counts) {
  if (counts.headings.size() != kHeadings)
    throw common::DataError("looks without a pose: " + std::to_string(counts.headings.size()) +
                            " bins of headings, expected " + std::to_string(kHeadings));
  counts_ = std::move(counts);
}

void RefusalMap::add(const control::PoseEstimate& estimate) {
  ++counts_.all.looks;
  if (!estimate.valid) {
    ++counts_.all.refused;
    ++counts_.waiting;
    std::map<std::string, std::int64_t>& reasons = counts_.reasons;
    const bool room = reasons.size() < kMostReasons || reasons.count(estimate.reason) != 0;
    ++reasons[room ? estimate.reason : kOtherReasons];
    return;
  }
  const double side_m = 2.0 * radius_m_ / kAcross;
  const auto cell = [&](double at_m) { return static_cast<int>(std::floor((at_m + radius_m_) / side_m)); };
  const double turns =
      (geometry::wrap_angle(estimate.pose.heading_rad) + geometry::kPi) / (2.0 * geometry::kPi);
  const int heading = std::clamp(static_cast<int>(turns * kHeadings), 0, kHeadings - 1);
  for (LookCount* count : {&counts_.cells[cell(estimate.pose.x_m)][cell(estimate.pose.y_m)],
                           &counts_.headings[static_cast<std::size_t>(heading)]}) {
    count->looks += 1 + counts_.waiting;
    count->refused += counts_.waiting;
  }
  counts_.waiting = 0;
}

runs::RefusalFigures RefusalMap::figures() const {
  runs::RefusalFigures figures;
  const LookCount& all = counts_.all;
  figures.share.n = all.looks;
  if (all.looks > 0) {
    figures.share.value = static_cast<double>(all.refused) / static_cast<double>(all.looks);
    const common::Interval interval = common::wilson_interval(all.refused, all.looks);
    figures.share.interval = std::array<double, 2>{interval.low, interval.high};
  }
  figures.cell_mm = geometry::kMmPerM * 2.0 * radius_m_ / kAcross;
  figures.heading_bin_deg = 360.0 / kHeadings;
  for (const auto& [column, rows] : counts_.cells)
    for (const auto& [row, count] : rows) {
      runs::RefusalBin bin;
      bin.x_mm = (column + 0.5) * figures.cell_mm - geometry::kMmPerM * radius_m_;
      bin.y_mm = (row + 0.5) * figures.cell_mm - geometry::kMmPerM * radius_m_;
      bin.looks = count.looks;
      bin.refused = count.refused;
      figures.cells.push_back(bin);
    }
  for (std::size_t i = 0; i < counts_.headings.size(); ++i) {
    runs::RefusalBin bin;
    bin.heading_from_deg = -180.0 + static_cast<double>(i) * figures.heading_bin_deg;
    bin.looks = counts_.headings[i].looks;
    bin.refused = counts_.headings[i].refused;
    figures.headings.push_back(bin);
  }
  figures.reasons = counts_.reasons;
  return figures;
}

}  // namespace lodestone::experiments
