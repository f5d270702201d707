#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lodestone::inference {

enum class ElementType { kFloat32, kFloat64, kInt64, kUint8 };

template <class Number>
constexpr ElementType element_type();
template <>
constexpr ElementType element_type<float>() {
  return ElementType::kFloat32;
}
template <>
constexpr ElementType element_type<double>() {
  return ElementType::kFloat64;
}
template <>
constexpr ElementType element_type<std::int64_t>() {
  return ElementType::kInt64;
}
template <>
constexpr ElementType element_type<std::uint8_t>() {
  return ElementType::kUint8;
}

/// Bytes of one number.
std::size_t element_size(ElementType type);

/// Numbers with a shape, row-major and contiguous. Copies share the numbers, which nobody writes to.
class Array {
 public:
  Array() = default;
  /// `numbers` point to as many as the shape says, and live as long as the pointer.
  Array(ElementType type, std::vector<std::int64_t> shape, std::shared_ptr<const void> numbers);
  /// Throws LogicFault when the shape does not hold as many numbers.
  template <class Number>
  Array(std::vector<Number> numbers, std::vector<std::int64_t> shape)
      : Array(std::make_shared<const std::vector<Number>>(std::move(numbers)), std::move(shape)) {}

  ElementType type() const { return type_; }
  const std::vector<std::int64_t>& shape() const { return shape_; }
  std::size_t size() const { return size_; }  ///< numbers
  std::size_t bytes() const { return size_ * element_size(type_); }
  const std::shared_ptr<const void>& owner() const { return numbers_; }
  /// Throws LogicFault when it holds another type.
  template <class Number>
  const Number* data() const {
    check_type(element_type<Number>());
    return static_cast<const Number*>(numbers_.get());
  }
  /// A copy of the numbers, converted.
  std::vector<double> to_double() const;
  template <class Number>
  std::vector<Number> to_vector() const {
    return {data<Number>(), data<Number>() + size_};
  }
  /// "[3, 2] float32", for messages.
  std::string text() const;

 private:
  template <class Number>
  Array(const std::shared_ptr<const std::vector<Number>>& owner, std::vector<std::int64_t> shape)
      : Array(element_type<Number>(), std::move(shape), std::shared_ptr<const void>(owner, owner->data())) {
    check_size(owner->size());
  }
  void check_type(ElementType type) const;
  void check_size(std::size_t size) const;

  ElementType type_ = ElementType::kFloat32;
  std::vector<std::int64_t> shape_ = {0};
  std::size_t size_ = 0;
  std::shared_ptr<const void> numbers_;
};

/// Arrays by name; order is the names'.
using Arrays = std::map<std::string, Array>;

/// Throws CheckpointError naming `what` and the place when a number is NaN or infinite.
void check_finite(const Array& array, const std::string& what);

/// Equal type, shape and bits.
bool identical(const Array& one, const Array& other);

}  // namespace lodestone::inference
