#include "lodestone/inference/array.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lodestone/common/error.h"

namespace lodestone::inference {
namespace {

const char* name_of(ElementType type) {
  switch (type) {
    case ElementType::kFloat32:
      return "float32";
    case ElementType::kFloat64:
      return "float64";
    case ElementType::kInt64:
      return "int64";
    default:
      return "uint8";
  }
}

template <class Number>
std::vector<double> widened(const Number* numbers, std::size_t size) {
  return {numbers, numbers + size};
}

}  // namespace

std::size_t element_size(ElementType type) {
  switch (type) {
    case ElementType::kFloat32:
      return sizeof(float);
    case ElementType::kUint8:
      return 1;
    default:
      return 8;
  }
}

Array::Array(ElementType type, std::vector<std::int64_t> shape, std::shared_ptr<const void> numbers)
    : type_(type), shape_(std::move(shape)), size_(1), numbers_(std::move(numbers)) {
  for (const std::int64_t length : shape_) size_ *= static_cast<std::size_t>(length);
}

std::vector<double> Array::to_double() const {
  switch (type_) {
    case ElementType::kFloat32:
      return widened(data<float>(), size_);
    case ElementType::kFloat64:
      return widened(data<double>(), size_);
    case ElementType::kInt64:
      return widened(data<std::int64_t>(), size_);
    default:
      return widened(data<std::uint8_t>(), size_);
  }
}

std::string Array::text() const {
  std::string text = "[";
  for (const std::int64_t length : shape_) text += (text.size() > 1 ? ", " : "") + std::to_string(length);
  return text + "] " + name_of(type_);
}

void Array::check_type(ElementType type) const {
  LODESTONE_CHECK(type == type_, std::string("an array of ") + name_of(type) + ", not " + text());
}

void Array::check_size(std::size_t size) const {
  LODESTONE_CHECK(size == size_, "shape " + text() + " does not hold " + std::to_string(size) + " numbers");
}

void check_finite(const Array& array, const std::string& what) {
  const auto check = [&](const auto* numbers) {
    const auto* bad =
        std::find_if_not(numbers, numbers + array.size(), [](auto x) { return std::isfinite(x); });
    if (bad != numbers + array.size())
      throw common::CheckpointError(what + " holds " + std::to_string(*bad) + " at place " +
                                    std::to_string(bad - numbers) + "; every number must be finite");
  };
  if (array.type() == ElementType::kFloat32) check(array.data<float>());
  if (array.type() == ElementType::kFloat64) check(array.data<double>());
}

bool identical(const Array& one, const Array& other) {
  return one.type() == other.type() && one.shape() == other.shape() &&
         (one.bytes() == 0 || std::memcmp(one.owner().get(), other.owner().get(), one.bytes()) == 0);
}

}  // namespace lodestone::inference
