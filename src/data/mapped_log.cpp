#include "lodestone/data/mapped_log.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "import_rows.h"
#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/common/shown.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::data {
namespace {

using common::CsvFormat;
using common::CsvTable;
using common::DataError;
using common::shown;

constexpr std::size_t kFirstRows = 5;
constexpr double kLargestTime_s = 1e11;
constexpr double kLargestPixel = 1e6;

struct NamedSeparator {
  Separator separator;
  char character;
};
constexpr std::array<NamedSeparator, 5> kSeparators = {{{Separator::kComma, ','},
                                                        {Separator::kSemicolon, ';'},
                                                        {Separator::kTab, '\t'},
                                                        {Separator::kBar, '|'},
                                                        {Separator::kBlank, ' '}}};

std::string read_header(const std::string& path, const CsvFormat& format, std::vector<std::string>& header) {
  try {
    header = CsvTable(path, format).header();
    return "";
  } catch (const DataError& error) {
    return error.what();
  }
}

/// The format with the separator that gives every column of the map, else the most of them, else the most
/// cells: with that, find_columns() says what is missing.
CsvFormat find_separator(const std::string& path, const MapConfig& config, const std::vector<MapEntry>& map) {
  CsvFormat best;
  std::pair<std::size_t, std::size_t> most;  // columns of the map, cells
  for (const NamedSeparator& known : kSeparators) {
    if (config.separator != Separator::kAuto && config.separator != known.separator) continue;
    const CsvFormat format = {known.character, '.', config.header_line};
    std::vector<std::string> header;
    if (const std::string fault = read_header(path, format, header); !fault.empty()) {
      if (config.separator == Separator::kAuto) continue;
      throw DataError(fault);
    }
    if (header.size() == 1 && config.separator != Separator::kAuto)
      throw DataError(path + ": holds one column only with separator " + common::name_of(config.separator) +
                      ": \"" + shown(header.front()) + "\"; leave map.separator at auto");
    try {
      find_columns(map, config.units, header, path);
      return format;
    } catch (const DataError&) {
      const std::pair<std::size_t, std::size_t> has = {columns_found(map, header), header.size()};
      if (has <= most) continue;
      most = has;
      best = format;
    }
  }
  if (most.second == 0) CsvTable{path, best};  // says what is wrong with the file
  return best;
}

/// Whether the numbers have a decimal comma: what the first row with either says.
char find_decimal(const std::string& path, const CsvFormat& format,
                  const std::vector<MappedColumn>& columns) {
  CsvTable table(path, format);
  while (table.next()) {
    bool comma = false, point = false;
    for (const MappedColumn& column : columns) {
      if (column.index >= table.cells()) continue;
      comma = comma || table.text(column.index).find(',') != std::string::npos;
      point = point || table.text(column.index).find('.') != std::string::npos;
    }
    if (comma || point) return comma && !point ? ',' : '.';
  }
  return '.';
}

/// Reads the cells of one row as what they mean.
class RowReader {
 public:
  RowReader(const CsvTable& table, const CsvImportConfig& config, const MapConfig& map, MappedLog& log)
      : table_(table), config_(config), map_(map), log_(log) {
    for (const MappedColumn& column : log.columns) {
      if (column.quantity == Quantity::kTime) time_ = column;
      if (column.quantity == Quantity::kX) x_ = column;
      if (column.quantity == Quantity::kY) y_ = column;
      if (column.quantity == Quantity::kHeading) heading_ = column;
      if (column.quantity == Quantity::kCurrents) currents_.push_back(column);
    }
  }

  void check_lengths(const std::string& path) const {
    const bool pixels = x_.unit.pixels();
    if (pixels != y_.unit.pixels())
      throw DataError(path + ": one of x (" + x_.unit.name + ") and y (" + y_.unit.name + ") is in pixels");
    if (pixels && map_.pixel_m <= 0.0 && !map_.to_dish)
      throw DataError(path +
                      ": positions are in pixels: say where the camera stands (--calibration "
                      "calibration.json) or how long a pixel is (--pixel-m 9e-5)");
    if (!pixels && (map_.pixel_m > 0.0 || map_.to_dish))
      throw DataError(path + ": positions are in " + x_.unit.name + ": pixels have no use here");
    if (map_.to_dish && (config_.centre_x != 0.0 || config_.centre_y != 0.0))
      throw common::ConfigError(
          "centre_x and centre_y must be 0 with --calibration, which says where the dish is");
  }

  LogSample read() {
    LogSample sample;
    sample.line = table_.line();
    sample.time_s =
        number_within(table_, time_.index, kLargestTime_s / time_.unit.factor) * time_.unit.factor;
    sample.pose = pose();
    sample.drive = drive();
    if (!log_.samples.empty() && sample.time_s <= log_.samples.back().time_s)
      table_.fail(time_.index,
                  fmt::format("later than the row before (line {}), which is {:g} s after it",
                              log_.samples.back().line, log_.samples.back().time_s - sample.time_s));
    return sample;
  }

 private:
  geometry::Pose2 pose() {
    const double up = config_.y_down ? -1.0 : 1.0;
    const double angle_rad =
        log_.heading ? number_within(table_, heading_.index, kLargestAngle) * heading_.unit.factor : 0.0;
    log_.most_turned_rad = std::max(log_.most_turned_rad, std::abs(angle_rad));
    const double bound = x_.unit.pixels() ? kLargestPixel : kFarthestGlitch_m / x_.unit.factor;
    const double x = number_within(table_, x_.index, bound);
    const double y = number_within(table_, y_.index, bound);
    if (map_.to_dish) return map_.to_dish(x, y, up * angle_rad);
    const double x_scale = x_.unit.pixels() ? map_.pixel_m : x_.unit.factor;
    const double y_scale = y_.unit.pixels() ? map_.pixel_m : y_.unit.factor;
    return {(x - config_.centre_x) * x_scale, up * (y - config_.centre_y) * y_scale,
            geometry::wrap_angle(up * angle_rad)};
  }

  /// Of one column, in the unit of the actions; smaller ones than the noise count as zero.
  double current(std::size_t which) const {
    const MappedColumn& column = currents_[which];
    const bool percent = column.unit.percent();
    const double per_unit =
        percent && log_.action_unit == "A" ? log_.action_scale / kFullDrivePercent : column.unit.factor;
    const double value = table_.number(column.index) * per_unit;
    const double noise = log_.action_unit == "A"
                             ? config_.current_noise_A
                             : config_.current_noise_A / config_.max_current_A * kFullDrivePercent;
    if (std::abs(value) <= noise) return 0.0;
    const double bound = (percent ? 1.0 : kCurrentMargin) * log_.action_scale;
    if (std::abs(value) > bound)
      table_.fail(column.index, fmt::format("within {:g} .. {:g} {} (unit {}; see rig.coils.max_current_A)",
                                            -bound, bound, log_.action_unit, column.unit.name));
    return value;
  }

  double pair(std::size_t plus, std::size_t minus) {
    const std::array<double, 2> value = {current(plus), current(minus)};
    std::array<double, 2> on = {0.0, 0.0};  // of the two coils
    bool reversed = false;
    for (std::size_t i = 0; i < 2; ++i) {
      if (value[i] < 0.0 && map_.negative_current == NegativeCurrent::kRefuse)
        table_.fail(currents_[i == 0 ? plus : minus].index,
                    "0 or more (map.negative_current=opposite: the opposite coil is on)");
      reversed = reversed || value[i] < 0.0;
      on[value[i] < 0.0 ? 1 - i : i] += std::abs(value[i]);
    }
    log_.reversed += reversed ? 1 : 0;
    if (on[0] == 0.0 || on[1] == 0.0) return on[0] - on[1];
    if (map_.opposite_currents == OppositeCurrents::kRefuse)
      table_.fail(currents_[minus].index,
                  "0: the opposite coil (" + shown(currents_[plus].header) + " = " +
                      shown(table_.text(currents_[plus].index)) +
                      ") is on as well (map.opposite_currents=net: the difference counts)");
    ++log_.netted;
    return on[0] - on[1];
  }

  double signed_axis(std::size_t which) {
    const double value = current(which);
    if (value < 0.0 && map_.negative_current == NegativeCurrent::kRefuse)
      table_.fail(currents_[which].index,
                  "0 or more (map.negative_current=opposite: the opposite coil is on)");
    log_.reversed += value < 0.0 ? 1 : 0;
    return value;
  }

  geometry::Vector2 drive() {
    if (currents_.size() == 2) return {signed_axis(0), signed_axis(1)};
    const double x = pair(0, 1);
    return {x, pair(2, 3)};
  }

  const CsvTable& table_;
  const CsvImportConfig& config_;
  const MapConfig& map_;
  MappedLog& log_;
  MappedColumn time_, x_, y_, heading_;
  std::vector<MappedColumn> currents_;
};

/// What a drive of 1 is: ampere, also of per cent where the rig says what they are of.
void settle_scale(MappedLog& log, const CsvImportConfig& config, const std::string& path) {
  const std::vector<MappedColumn> currents = log.of(Quantity::kCurrents);
  const bool percent = currents.front().unit.percent();
  for (const MappedColumn& column : currents)
    if (column.unit.percent() != percent)
      throw DataError(path + ": some currents are in per cent, and \"" + shown(column.header) + "\" is in " +
                      column.unit.name);
  log.action_scale = config.max_current_A;
  if (!percent) return;
  log.action_scale = config.full_drive_A > 0.0 ? config.full_drive_A : kFullDrivePercent;
  log.action_unit = config.full_drive_A > 0.0 ? "A" : "percent";
}

void describe_rest(MappedLog& log, const CsvTable& table) {
  for (std::size_t i = 0; i < table.header().size(); ++i) {
    const bool used = std::any_of(log.columns.begin(), log.columns.end(),
                                  [i](const MappedColumn& column) { return column.index == i; });
    if (!used) log.ignored.push_back(table.header()[i]);
  }
}

}  // namespace

std::vector<MappedColumn> MappedLog::of(Quantity quantity) const {
  std::vector<MappedColumn> found;
  std::copy_if(columns.begin(), columns.end(), std::back_inserter(found),
               [&](const MappedColumn& column) { return column.quantity == quantity; });
  return found;
}

MappedLog read_mapped_log(const std::string& path, const CsvImportConfig& config, const MapConfig& map,
                          CsvImportResult& result) {
  const std::vector<MapEntry> entries = parse_map(map.columns);
  MappedLog log;
  log.format = find_separator(path, map, entries);
  {
    const CsvTable table(path, log.format);
    log.columns = find_columns(entries, map.units, table.header(), fmt::format("{}:{}", path, table.line()));
  }
  log.format.decimal = map.decimal == Decimal::kAuto    ? find_decimal(path, log.format, log.columns)
                       : map.decimal == Decimal::kComma ? ','
                                                        : '.';
  log.heading = !log.of(Quantity::kHeading).empty();
  settle_scale(log, config, path);

  CsvTable table(path, log.format);
  describe_rest(log, table);
  RowReader reader(table, config, map, log);
  reader.check_lengths(path);
  const auto read = [&] {
    log.samples.push_back(reader.read());
    if (log.first_rows.size() < kFirstRows) {
      std::vector<std::string> cells;
      for (const MappedColumn& column : log.columns) cells.push_back(table.text(column.index));
      log.first_rows.push_back(std::move(cells));
    }
  };
  for_each_row(table, config, result, read, [] {});
  return log;
}

}  // namespace lodestone::data
