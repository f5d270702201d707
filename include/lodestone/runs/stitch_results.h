#pragma once

#include <array>

namespace lodestone::runs {

/// One stitch of a trial: how the needle should have lain where it went in and where it came out, x and y in
/// mm, heading in rad.
struct StitchRecord {
  std::array<double, 3> entry = {};
  std::array<double, 3> exit = {};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("entry", entry);
    v.field("exit", exit);
  }
  bool operator==(const StitchRecord& other) const { return entry == other.entry && exit == other.exit; }
};

/// How well one stitch went: the needle at the moment at which it was nearest to each end.
struct StitchFigures {
  bool made = false;
  double entry_error_mm = 0.0, entry_heading_deg = 0.0;
  double exit_error_mm = 0.0, exit_heading_deg = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("made", made);
    v.field("entry_error_mm", entry_error_mm);
    v.field("entry_heading_deg", entry_heading_deg);
    v.field("exit_error_mm", exit_error_mm);
    v.field("exit_heading_deg", exit_heading_deg);
  }
};

}  // namespace lodestone::runs
