#include "lodestone/common/json.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <unordered_set>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/shown.h"

namespace lodestone::common {
namespace {

// What lies beyond is no file of ours, and would cost time or memory out of proportion to its size.
constexpr std::size_t kDeepest = 64;
constexpr std::size_t kMostKeys = 10'000;  // of an object, whose keys are looked up one after the other
constexpr std::size_t kMostValues = 20'000'000;

/// A text that tells how far it was read.
class Cursor {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Cursor(const char* at, const char** furthest) : at_(at), furthest_(furthest) {}
  const char& operator*() const { return *at_; }
  Cursor& operator++() {
    *furthest_ = ++at_;
    return *this;
  }
  bool operator==(const Cursor& other) const { return at_ == other.at_; }
  bool operator!=(const Cursor& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** furthest_;
};

/// What nlohmann-json says about a fault, without its own name and place.
std::string reason_of(const std::string& what) {
  const std::size_t syntax = what.find("syntax error ");
  if (syntax != std::string::npos) return "not JSON: " + shown(what.substr(syntax));
  const std::size_t bracket = what.find("] ");
  return "not JSON: " + shown(bracket == std::string::npos ? what : what.substr(bracket + 2));
}

/// Builds the value while it is parsed, and stops at the first thing that is too much.
class Builder : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t& /*as written*/) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t& /*value*/) override { return refuse("binary values are no JSON"); }
  bool start_object(std::size_t /*size*/) override { return open(Json::object()); }
  bool start_array(std::size_t /*size*/) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    std::unordered_set<std::string>& seen = open_.back().keys;
    if (!seen.insert(name).second) return refuse("the key \"" + shown(name) + "\" is given twice");
    if (seen.size() > kMostKeys) return refuse(fmt::format("more than {} keys in one object", kMostKeys));
    key_ = std::move(name);
    return true;
  }
  bool parse_error(std::size_t /*position*/, const std::string& token,
                   const nlohmann::detail::exception& error) override {
    constexpr int kOverflow = 406;
    if (error.id == kOverflow) return refuse("the number " + shown(token) + " is too large");
    return refuse(reason_of(error.what()));
  }

  Json take() { return std::move(root_); }
  const std::string& fault() const { return fault_; }

 private:
  struct Open {
    Json* value;
    std::unordered_set<std::string> keys;
  };

  bool refuse(const std::string& fault) {
    fault_ = fault;
    return false;
  }

  /// Puts a value where the next one belongs; nullptr when it is one too many.
  Json* place(Json value) {
    if (++values_ > kMostValues) {
      fault_ = fmt::format("more than {} values", kMostValues);
      return nullptr;
    }
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    Json& parent = *open_.back().value;
    if (parent.is_array()) return &parent.get_ref<Json::array_t&>().emplace_back(std::move(value));
    return &parent.get_ref<Json::object_t&>()
                .Container::emplace_back(std::move(key_), std::move(value))
                .second;
  }
  bool put(Json value) { return place(std::move(value)) != nullptr; }
  bool open(Json value) {
    if (open_.size() == kDeepest) return refuse(fmt::format("nested deeper than {} levels", kDeepest));
    Json* placed = place(std::move(value));
    if (placed != nullptr) open_.push_back({placed, {}});
    return placed != nullptr;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  Json root_;
  std::vector<Open> open_;
  std::string key_;
  std::string fault_;
  std::size_t values_ = 0;
};

struct Parsed {
  Json json;
  std::string fault;  ///< empty: none
  std::size_t bytes;  ///< read until it was found
};

Parsed parsed(std::string_view text, JsonComments comments) {
  const char* furthest = text.data();
  Builder builder;
  Json::sax_parse(Cursor(text.data(), &furthest), Cursor(text.data() + text.size(), &furthest), &builder,
                  nlohmann::detail::input_format_t::json, /*strict=*/true,
                  comments == JsonComments::kAllowed);
  return {builder.take(), builder.fault(), static_cast<std::size_t>(furthest - text.data())};
}

}  // namespace

Json parse_json(std::string_view text, const std::string& source, JsonComments comments) {
  Parsed result = parsed(text, comments);
  if (result.fault.empty()) return std::move(result.json);
  const std::string_view before = text.substr(0, result.bytes > 0 ? result.bytes - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_break = before.rfind('\n');
  const std::size_t column = before.size() - (line_break == std::string_view::npos ? 0 : line_break + 1) + 1;
  throw DataError(fmt::format("{}:{}:{}: {}", source, line, column, result.fault));
}

std::optional<Json> find_json(std::string_view text) {
  Parsed result = parsed(text, JsonComments::kRefused);
  if (!result.fault.empty()) return std::nullopt;
  return std::move(result.json);
}

std::string shown_json(const Json& value) {
  return shown(std::string_view(value.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

}  // namespace lodestone::common
