#include "lodestone/physics/field_samples.h"

#include <fmt/core.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <utility>

#include "lodestone/common/csv_table.h"
#include "lodestone/common/error.h"
#include "lodestone/physics/per_coil.h"

namespace lodestone::physics {
namespace {

constexpr double kLargest_m = 1.0;
constexpr double kLargest_A = 1000.0;
constexpr double kLargest_T = 10.0;

/// A column, and what its unit is in SI.
struct Column {
  std::size_t index = 0;
  double unit = 1.0;
};

using Units = std::vector<std::pair<const char*, double>>;

Column find(const common::CsvTable& table, const std::string& path, const std::string& name,
            const Units& units) {
  std::string known;
  for (const auto& [unit, in_si] : units) {
    const std::string column = name + "_" + unit;
    if (table.has_columns({column})) return {table.column(column), in_si};
    known += (known.empty() ? "" : " or ") + column;
  }
  throw common::DataError(path + ": there is no column " + known +
                          (table.has_columns({name}) ? ": " + name + " says no unit" : ""));
}

double number(const common::CsvTable& table, const Column& column, double largest, const char* meant) {
  const double value = column.unit * table.number(column.index);
  if (std::abs(value) > largest)
    table.fail(column.index, fmt::format("within +-{:g} {}; is its unit the one that its name says?",
                                         largest / column.unit, meant));
  return value;
}

std::vector<Column> current_columns(const common::CsvTable& table, const std::string& path) {
  std::vector<Column> found;
  for (std::size_t coil = 1; coil <= kMostCoils + 1; ++coil)
    for (const char* prefix : {"current_", "I_"}) {
      const std::string name = prefix + std::to_string(coil) + "_A";
      if (!table.has_columns({name})) continue;
      if (found.size() + 1 != coil)
        throw common::DataError(
            fmt::format("{}: {} is there, but no current of coil {}", path, name, coil - 1));
      found.push_back({table.column(name), 1.0});
    }
  if (found.empty())
    throw common::DataError(path + ": there is no column current_1_A (current_2_A, ...) or I_1_A");
  if (found.size() > kMostCoils)
    throw common::DataError(fmt::format("{}: more than {} coils", path, kMostCoils));
  return found;
}

/// Throws where the samples cannot tell the coils apart.
void check_currents(const FieldSamples& samples, const std::string& path) {
  Eigen::MatrixXd currents(static_cast<Eigen::Index>(samples.size()),
                           static_cast<Eigen::Index>(samples.coils));
  for (std::size_t i = 0; i < samples.size(); ++i)
    currents.row(static_cast<Eigen::Index>(i)) = samples.current_A[i].transpose();
  for (Eigen::Index coil = 0; coil < currents.cols(); ++coil)
    if (currents.col(coil).isZero(0.0))
      throw common::DataError(
          fmt::format("{}: coil {} has no current in any row, so nothing says what it does", path, coil + 1));
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposed(currents);
  decomposed.setThreshold(1e-6);
  if (decomposed.rank() < currents.cols())
    throw common::DataError(
        path +
        ": the currents of some coils always go together (or a coil is listed twice): drive "
        "each of them by itself, too");
}

}  // namespace

FieldSamples read_field_samples(const std::string& path) {
  common::CsvTable table(path);
  const Units lengths = {{"m", 1.0}, {"mm", 1e-3}};
  const Units fields = {{"T", 1.0}, {"mT", 1e-3}, {"uT", 1e-6}};
  std::array<Column, 3> place, field;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place[axis] = find(table, path, std::string(1, "xyz"[axis]), lengths);
    field[axis] = find(table, path, std::string("B") + "xyz"[axis], fields);
  }
  const std::vector<Column> currents = current_columns(table, path);
  FieldSamples samples;
  samples.coils = currents.size();
  while (table.next()) {
    table.check_width();
    Eigen::Vector3d position_m, field_T;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      position_m[row] = number(table, place[axis], kLargest_m, place[axis].unit == 1.0 ? "m" : "mm");
      field_T[row] = number(table, field[axis], kLargest_T, field[axis].unit == 1.0 ? "T" : "of its unit");
    }
    Eigen::VectorXd current_A(static_cast<Eigen::Index>(currents.size()));
    for (std::size_t coil = 0; coil < currents.size(); ++coil)
      current_A[static_cast<Eigen::Index>(coil)] = number(table, currents[coil], kLargest_A, "A");
    samples.position_m.push_back(position_m);
    samples.field_T.push_back(field_T);
    samples.current_A.push_back(std::move(current_A));
  }
  if (samples.size() == 0) throw common::DataError(path + ": holds no row");
  check_currents(samples, path);
  return samples;
}

}  // namespace lodestone::physics
