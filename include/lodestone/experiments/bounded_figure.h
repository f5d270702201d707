#pragma once

#include <string>

namespace lodestone::experiments {

/// One number that must keep to a bound.
struct BoundedFigure {
  std::string figure;
  double value = 0.0;
  std::string unit;
  double bound = 0.0;
  bool ok = false;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("figure", figure);
    v.field("value", value);
    v.field("unit", unit);
    v.field("bound", bound);
    v.field("ok", ok);
  }
};

inline BoundedFigure at_most(const std::string& figure, double value, const std::string& unit, double bound) {
  return {figure, value, unit, bound, value <= bound};
}

}  // namespace lodestone::experiments
