#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/geometry/keep_out.h"
#include "lodestone/safety/check.h"
#include "lodestone/safety/zones_file.h"

namespace lodestone::safety {

/// A needle that may lie within the margin of a zone that it must keep out of.
class KeepOutCheck final : public PoseCheck {
 public:
  /// Its zones, and those that a file holds now, whenever now is.
  explicit KeepOutCheck(geometry::KeepOut keep_out, std::string file = {})
      : zones_(std::move(keep_out.zones)), file_(std::move(file)), keep_out_(std::move(keep_out)) {}
  void observe(const control::PoseEstimate& estimate, double now_s) override;

  /// Throws Distrust where the file cannot be read.
  void look();
  /// From any thread: from the next pose on it is these zones, beside those of the file.
  void move_zones(std::vector<geometry::Zone> zones);
  /// From any thread: all of them now; where the file cannot be read, as it was read last.
  std::vector<geometry::Zone> zones();

 private:
  /// Under the mutex. `anew`: by what the file holds now; throws Distrust.
  void put_together(bool anew);

  mutable std::mutex mutex_;           // of all below
  std::vector<geometry::Zone> zones_;  // but for those of the file
  ZonesFile file_;
  std::vector<geometry::Zone> moving_;  // those of the file
  geometry::KeepOut keep_out_;
};

}  // namespace lodestone::safety
