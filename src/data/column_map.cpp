#include "lodestone/data/column_map.h"

#include <algorithm>
#include <optional>
#include <set>

#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/common/shown.h"
#include "lodestone/common/spelling.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::data {
namespace {

using common::ConfigError;
using common::joined;
using common::name_of;
using common::shown;

const std::vector<Unit>& units_of(Quantity quantity) {
  static const std::vector<Unit> kTimes = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60.0}};
  static const std::vector<Unit> kLengths = {
      {"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"px", 1.0}};
  static const std::vector<Unit> kAngles = {{"rad", 1.0}, {"deg", geometry::kRadPerDeg}};
  static const std::vector<Unit> kCurrents = {{"A", 1.0}, {"mA", 1e-3}, {"%", 1.0}};
  switch (quantity) {
    case Quantity::kTime:
      return kTimes;
    case Quantity::kX:
    case Quantity::kY:
      return kLengths;
    case Quantity::kHeading:
      return kAngles;
    case Quantity::kCurrents:
      break;
  }
  return kCurrents;
}

std::string unit_names(Quantity quantity) {
  std::vector<std::string> names;
  for (const Unit& unit : units_of(quantity)) names.push_back(unit.name);
  return joined(names);
}

std::optional<Unit> find_unit(Quantity quantity, const std::string& name) {
  for (const Unit& unit : units_of(quantity))
    if (unit.name == name) return unit;
  return std::nullopt;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Parts between separators that do not stand in double quotes, quotes kept.
std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (c == separator && !quoted)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::string unquoted(const std::string& text) {
  std::string plain = trimmed(text);
  if (plain.size() >= 2 && plain.front() == '"' && plain.back() == '"')
    plain = plain.substr(1, plain.size() - 2);
  return plain;
}

/// "quantity=value" of an argument.
std::pair<Quantity, std::string> assignment(const std::string& part, const std::string& argument) {
  const std::vector<std::string> names = names_of(Quantity{});
  const std::size_t equals = part.find('=');
  const std::string name = trimmed(part.substr(0, equals));
  const std::optional<Quantity> quantity = common::find_named<Quantity>(name);
  if (equals == std::string::npos || !quantity)
    throw ConfigError(argument + ": \"" + shown(trimmed(part)) + "\" must be QUANTITY=..., and " +
                      common::spelling_hint(name, names, "quantities"));
  const std::string value = part.substr(equals + 1);
  if (trimmed(value).empty()) throw ConfigError(argument + ": " + name + " is given nothing");
  return {*quantity, value};
}

void check_complete(const std::vector<MapEntry>& map) {
  for (const Quantity quantity : {Quantity::kTime, Quantity::kX, Quantity::kY, Quantity::kCurrents}) {
    const auto count = std::count_if(map.begin(), map.end(),
                                     [&](const MapEntry& entry) { return entry.quantity == quantity; });
    if (count == 0)
      throw ConfigError("--map: " + name_of(quantity) +
                        " is missing; time, x, y and currents are needed, such as " +
                        "\"time=Time [s],x=X [mm],y=Y [mm],currents=I1|I2|I3|I4\"");
  }
  std::set<std::string> used;
  std::set<Quantity> said;
  for (const MapEntry& entry : map) {
    if (!said.insert(entry.quantity).second)
      throw ConfigError("--map: " + name_of(entry.quantity) + " is given twice");
    for (const std::string& column : entry.columns)
      if (!used.insert(column).second)
        throw ConfigError("--map: column \"" + shown(column) + "\" is given two meanings");
  }
}

/// The header's name without its unit, and the unit as it stands there; nothing where it has none.
struct NamedUnit {
  std::string name;
  std::string unit;
};
std::optional<NamedUnit> unit_in(const std::string& header, Quantity quantity) {
  for (const char* brackets : {"[]", "()"}) {
    const std::size_t open = header.rfind(brackets[0]);
    if (open != std::string::npos && header.back() == brackets[1])
      return NamedUnit{trimmed(header.substr(0, open)),
                       trimmed(header.substr(open + 1, header.size() - open - 2))};
  }
  const std::size_t line = header.rfind('_');
  if (line == std::string::npos || !find_unit(quantity, header.substr(line + 1))) return std::nullopt;
  return NamedUnit{header.substr(0, line), header.substr(line + 1)};
}

std::size_t find_column(const std::string& name, Quantity quantity, const std::vector<std::string>& header,
                        const std::string& place) {
  const auto exact = std::find(header.begin(), header.end(), name);
  if (exact != header.end()) return static_cast<std::size_t>(exact - header.begin());
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < header.size(); ++i) {
    const auto parts = unit_in(header[i], quantity);
    if (parts && parts->name == name) found.push_back(i);
  }
  if (found.size() == 1) return found.front();
  const std::string what = place + ": column \"" + shown(name) + "\" (" + name_of(quantity) + ") ";
  if (found.size() > 1)
    throw common::DataError(what + "may be \"" + shown(header[found[0]]) + "\" or \"" +
                            shown(header[found[1]]) + "\": give its whole name");
  std::vector<std::string> words;
  for (const std::string& word : header) words.push_back(shown(word));
  throw common::DataError(what + "is not in the header; " +
                          shown(common::spelling_hint(name, words, "its columns")));
}

Unit unit_of(const MappedColumn& column, const std::string& name, const std::string& place) {
  const auto written = unit_in(column.header, column.quantity);
  if (name.empty() && !written)
    throw common::DataError(place + ": column \"" + shown(column.header) + "\" (" + name_of(column.quantity) +
                            ") has no unit: write it behind the name, as in [" +
                            units_of(column.quantity).front().name + "], or give --units " +
                            name_of(column.quantity) + "=UNIT (" + unit_names(column.quantity) + ")");
  const std::string wanted = name.empty() ? written->unit : name;
  if (const auto unit = find_unit(column.quantity, wanted)) return *unit;
  throw common::DataError(place + ": column \"" + shown(column.header) + "\": unit " + shown(wanted) +
                          " of " + name_of(column.quantity) + " is none of " + unit_names(column.quantity));
}

}  // namespace

std::vector<MapEntry> parse_map(const std::string& text) {
  if (std::count(text.begin(), text.end(), '"') % 2 != 0)
    throw ConfigError("--map: a quote is opened and not closed");
  std::vector<MapEntry> map;
  for (const std::string& part : split(text, ',')) {
    const auto [quantity, value] = assignment(part, "--map");
    MapEntry entry{quantity, {}};
    for (const std::string& column : split(value, '|')) {
      entry.columns.push_back(unquoted(column));
      if (entry.columns.back().empty())
        throw ConfigError("--map: " + name_of(quantity) + " has a column without a name");
    }
    const std::size_t count = entry.columns.size();
    if (quantity == Quantity::kCurrents ? count != 4 && count != 2 : count != 1)
      throw ConfigError("--map: " + name_of(quantity) + " has " + std::to_string(count) + " columns, not " +
                        (quantity == Quantity::kCurrents ? "4 (+x|-x|+y|-y) or 2 (the pairs x|y)" : "1"));
    map.push_back(std::move(entry));
  }
  check_complete(map);
  return map;
}

std::size_t columns_found(const std::vector<MapEntry>& map, const std::vector<std::string>& header) {
  std::size_t found = 0;
  for (const MapEntry& entry : map)
    for (const std::string& name : entry.columns)
      found += std::any_of(header.begin(), header.end(), [&](const std::string& cell) {
        const auto parts = unit_in(cell, entry.quantity);
        return cell == name || (parts && parts->name == name);
      });
  return found;
}

std::vector<MappedColumn> find_columns(const std::vector<MapEntry>& map, const std::string& units,
                                       const std::vector<std::string>& header, const std::string& place) {
  std::vector<std::string> given(names_of(Quantity{}).size());
  if (!units.empty())
    for (const std::string& part : split(units, ',')) {
      const auto [quantity, unit] = assignment(part, "--units");
      if (!find_unit(quantity, trimmed(unit)))
        throw ConfigError("--units: " + shown(trimmed(unit)) + " of " + name_of(quantity) + " is none of " +
                          unit_names(quantity));
      given[static_cast<std::size_t>(quantity)] = trimmed(unit);
    }
  std::vector<MappedColumn> columns;
  for (const MapEntry& entry : map)
    for (const std::string& name : entry.columns) {
      const std::string& unit = given[static_cast<std::size_t>(entry.quantity)];
      MappedColumn column;
      column.quantity = entry.quantity;
      column.index = find_column(name, entry.quantity, header, place);
      for (const MappedColumn& other : columns)
        if (other.index == column.index)
          throw common::DataError(place + ": column \"" + shown(other.header) + "\" is given two meanings, " +
                                  name_of(other.quantity) + " and " + name_of(entry.quantity));
      column.header = header[column.index];
      column.unit_given = !unit.empty();
      column.unit = unit_of(column, unit, place);
      columns.push_back(std::move(column));
    }
  return columns;
}

}  // namespace lodestone::data
