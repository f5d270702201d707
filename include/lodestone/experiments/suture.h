#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/control/suture_reference.h"
#include "lodestone/geometry/stitch.h"

namespace lodestone::experiments {

struct ControllerSource;
struct DeploymentConfig;

/// One stitch, as it is written.
struct StitchConfig {
  std::vector<double> entry_mm;
  double entry_deg = 0.0;
  std::vector<double> exit_mm;
  double exit_deg = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("entry_mm", entry_mm, "mm", "x, y of where the needle goes in", {-1000.0, 1000.0});
    v.field("entry_deg", entry_deg, "deg", "its heading there", {-360.0, 360.0});
    v.field("exit_mm", exit_mm, "mm", "x, y of where it comes out", {-1000.0, 1000.0});
    v.field("exit_deg", exit_deg, "deg", "its heading there", {-360.0, 360.0});
  }
  /// Throws InvalidConfig where a point is not of two numbers.
  void validate() const;
};

/// The stitches of the task `suture`: a running stitch across the dish centre, or those that are listed.
struct SutureConfig {
  std::vector<StitchConfig> stitches;
  std::int64_t count = 5;
  double length_m = 0.006;
  double pitch_m = 0.004;

  template <class Visitor>
  void visit(Visitor& v) {
    v.list("stitches", stitches, StitchConfig{},
           "one after another: entry_mm, entry_deg, exit_mm, exit_deg; []: `count` of them in a row");
    v.field("count", count, "",
            "stitches across a wound along x through the dish centre, up and down in turn", {1, 100});
    v.field("length_m", length_m, "m", "from entry to exit of each", {1e-4, 0.1});
    v.field("pitch_m", pitch_m, "m", "from each to the next one, along x", {0.0, 0.1});
  }
};

/// In the dish frame.
std::vector<geometry::Stitch> stitches_of(const SutureConfig& config);

/// How stitches are fed to the controller: what holds a needle near a target (hold, turning in place) has it
/// lie there, so a needle counts as arrived where it is held.
control::SutureReferenceConfig suture_reference(const DeploymentConfig& config);

/// Where this controller leads the needle so that it passes through the stitches, as it has rehearsed
/// (control::rehearsed()); where it cannot, or would come too near to wall or zone there, through them as
/// they are.
std::vector<geometry::Stitch> aims_of(const DeploymentConfig& config, const ControllerSource& source,
                                      const std::vector<geometry::Stitch>& stitches);

/// Throws ConfigError, naming the stitch, where a needle cannot be led through config's stitches: it is a
/// sphere, would not fit into the dish as it should lie, or come too near a zone; a heading points away from
/// the other end; or the ends are so near to each other that one place would count as both.
void check_stitches(const DeploymentConfig& config);

}  // namespace lodestone::experiments
