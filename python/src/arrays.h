#pragma once

#include <pybind11/numpy.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lodestone::python {

namespace py = pybind11;

/// Numbers that Python handed in, row after row.
template <class Number>
struct Rows {
  std::vector<Number> numbers;  ///< [count, columns]
  std::int64_t count = 0;
  bool single = false;  ///< it was one row without an axis of rows
};

/// An array-like of real numbers, of shape [columns] or [N, columns]. Throws TypeError for another dtype, and
/// ValueError for another shape and for a number that is not finite; both begin with `name`.
template <class Number>
Rows<Number> read_rows(const py::handle& value, const std::string& name, std::int64_t columns);
extern template Rows<float> read_rows(const py::handle&, const std::string&, std::int64_t);
extern template Rows<double> read_rows(const py::handle&, const std::string&, std::int64_t);

/// One row of that many numbers; throws as read_rows().
std::vector<double> read_row(const py::handle& value, const std::string& name, std::int64_t columns);

/// An array-like of real numbers of any shape, checked as read_rows() does, and its shape.
std::pair<std::vector<float>, std::vector<std::int64_t>> read_array(const py::handle& value,
                                                                    const std::string& name);

/// A numpy array of that shape, which owns the numbers.
template <class Number>
py::array array_of(std::vector<Number> numbers, const std::vector<py::ssize_t>& shape) {
  auto owned = std::make_unique<std::vector<Number>>(std::move(numbers));
  Number* data = owned->data();
  const py::capsule owner(owned.release(),
                          [](void* held) { delete static_cast<std::vector<Number>*>(held); });
  return py::array(py::dtype::of<Number>(), shape, data, owner);
}

}  // namespace lodestone::python
