#include "arrays.h"

#include <cmath>

namespace lodestone::python {
namespace {

std::string shape_text(const py::array& array) {
  std::string text = "[";
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis)
    text += (axis == 0 ? "" : ", ") + std::to_string(array.shape(axis));
  return text + "]";
}

/// The same in numbers of C; throws TypeError where it holds something else.
template <class Number>
py::array_t<Number, py::array::c_style> numbers_of(const py::handle& value, const std::string& name) {
  const auto array = py::array::ensure(value);
  if (!array) throw py::type_error(name + " is no array of numbers");
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    throw py::type_error(name + " is of dtype " + py::str(array.dtype()).cast<std::string>() +
                         ", must be real numbers (float32 or float64)");
  const auto converted = py::array_t<Number, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!converted) throw py::type_error(name + " cannot be read as real numbers");
  return converted;
}

/// Place of a number in row-major order, as "[row, column]".
std::string place_text(const py::array& array, py::ssize_t place) {
  std::string text = "]";
  for (py::ssize_t axis = array.ndim() - 1; axis >= 0; --axis) {
    text = (axis == 0 ? "" : ", ") + std::to_string(place % array.shape(axis)) + text;
    place /= array.shape(axis);
  }
  return "[" + text;
}

template <class Number>
std::vector<Number> finite_numbers(const py::array_t<Number, py::array::c_style>& array,
                                   const std::string& name) {
  std::vector<Number> numbers(array.data(), array.data() + array.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!std::isfinite(numbers[i]))
      throw py::value_error(name + (array.ndim() > 0 ? place_text(array, static_cast<py::ssize_t>(i)) : "") +
                            " is " + std::to_string(numbers[i]) + ", must be a finite number");
  return numbers;
}

}  // namespace

template <class Number>
Rows<Number> read_rows(const py::handle& value, const std::string& name, std::int64_t columns) {
  const auto array = numbers_of<Number>(value, name);
  const bool single = array.ndim() == 1;
  const bool fits = (single || array.ndim() == 2) && array.shape(array.ndim() - 1) == columns;
  if (!fits)
    throw py::value_error(name + " is of shape " + shape_text(array) + ", must be [" +
                          std::to_string(columns) + "] or [N, " + std::to_string(columns) + "]");
  return {finite_numbers<Number>(array, name), single ? 1 : array.shape(0), single};
}

template Rows<float> read_rows(const py::handle&, const std::string&, std::int64_t);
template Rows<double> read_rows(const py::handle&, const std::string&, std::int64_t);

std::vector<double> read_row(const py::handle& value, const std::string& name, std::int64_t columns) {
  const auto array = numbers_of<double>(value, name);
  if (array.ndim() != 1 || array.shape(0) != columns)
    throw py::value_error(name + " is of shape " + shape_text(array) + ", must be [" +
                          std::to_string(columns) + "]");
  return finite_numbers<double>(array, name);
}

std::pair<std::vector<float>, std::vector<std::int64_t>> read_array(const py::handle& value,
                                                                    const std::string& name) {
  const auto array = numbers_of<float>(value, name);
  return {finite_numbers<float>(array, name), {array.shape(), array.shape() + array.ndim()}};
}

}  // namespace lodestone::python
