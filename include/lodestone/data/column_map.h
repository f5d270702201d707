#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/data/map_config.h"

namespace lodestone::data {

/// What a column of a foreign log can mean.
enum class Quantity { kTime, kX, kY, kHeading, kCurrents };
inline std::vector<std::string> names_of(Quantity) { return {"time", "x", "y", "heading", "currents"}; }

/// A unit of a quantity, and how many SI units (ampere, radians) it is. Pixels and per cent have no size of
/// their own.
struct Unit {
  std::string name;
  double factor = 1.0;
  bool pixels() const { return name == "px"; }
  bool percent() const { return name == "%"; }
};

/// A column that has been found.
struct MappedColumn {
  Quantity quantity = Quantity::kTime;
  std::size_t index = 0;  ///< in the file
  std::string header;
  Unit unit;
  bool unit_given = false;  ///< by an argument, not by the header
};

/// One quantity and the names of its columns, as `--map` says it.
struct MapEntry {
  Quantity quantity = Quantity::kTime;
  std::vector<std::string> columns;
};

/// Reads `time=Time [s],x=X_px,...,currents=I1|I2|I3|I4`. Names with , = | or blanks at an end stand in
/// double quotes. Time, x, y and currents must be there, currents with one column for each coil in the order
/// of the rig (+x, -x, +y, -y) or with two, for the pairs x and y. Throws ConfigError.
std::vector<MapEntry> parse_map(const std::string& text);

/// How many of the map's columns the header has.
std::size_t columns_found(const std::vector<MapEntry>& map, const std::vector<std::string>& header);

/// Finds the columns: by the whole header, or by what it says before its unit where only one does. Units come
/// from `units` ("time=ms,x=px"), else from the header's end: "X [mm]", "X (mm)" or "X_mm". Throws
/// ConfigError for `units`, and DataError that begins with `place` for a column or unit that is missing.
std::vector<MappedColumn> find_columns(const std::vector<MapEntry>& map, const std::string& units,
                                       const std::vector<std::string>& header, const std::string& place);

}  // namespace lodestone::data
