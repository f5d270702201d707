#pragma once
// Fuzzing without a tool: good input is spoiled by a seeded stream, and what reads it may only accept it or
// throw an error that the user is told (common::Error). Any other exception fails the case; a signal, or 20 s
// for one input, ends the process, and the input is left in its file.
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "lodestone/common/random.h"
#include "lodestone/common/resource_use.h"
#include "soak.h"

namespace lodestone::tests {

/// Spoils bytes and JSON at random, with what usually breaks readers.
class Spoiler {
 public:
  Spoiler(std::uint64_t seed, const std::string& name) : random_(seed, name) {}

  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_.below(count)); }
  template <class List>
  const auto& one_of(const List& list) {
    return list[below(list.size())];
  }

  /// One to four changes; `other` is spliced in.
  std::string bytes(std::string text, const std::string& other) {
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) text = changed(std::move(text), other);
    return text;
  }

  /// One to three changes anywhere in a value.
  common::Json json(common::Json whole) {
    for (std::size_t changes = 1 + below(3); changes > 0; --changes) change(whole);
    return whole;
  }

 private:
  std::string changed(std::string text, const std::string& other) {
    const std::size_t at = below(text.size() + 1);
    const std::size_t length = std::min(text.size() - at, below(64));
    switch (below(9)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        return text;
      case 1:
        return text.substr(0, at);
      case 2:
        return text.erase(at, length);
      case 3:
        return text.insert(at, text.substr(at, length));
      case 4:
        return text.insert(at, std::string(1 + below(8), static_cast<char>(below(256))));
      case 5:
        return text.substr(0, at) + other.substr(std::min(other.size(), below(other.size() + 1)));
      case 6:
        return with_word(std::move(text), at);
      case 7:
        return with_number(std::move(text), at);
      default:
        return text.insert(at, nested());
    }
  }

  std::string nested() {
    static const std::vector<std::string> kOpen = {"[", "{\"a\":", "\"", "(", ","};
    const std::string& open = one_of(kOpen);
    std::string out;
    for (std::size_t depth = below(below(50) == 0 ? 100'000 : 100); depth > 0; --depth) out += open;
    return out;
  }

  /// Puts a number that readers stumble over into the place of a written one, the first behind `at`.
  std::string with_number(std::string text, std::size_t at) {
    static const std::vector<std::string> kNumbers = {"-1",
                                                      "0",
                                                      "-0",
                                                      "1e300",
                                                      "1e999",
                                                      "-1e999",
                                                      "NaN",
                                                      "inf",
                                                      "2147483648",
                                                      "0.5",
                                                      "null",
                                                      "4294967296",
                                                      "1e-320",
                                                      "9223372036854775808",
                                                      "18446744073709551616",
                                                      "\"\"",
                                                      "[]",
                                                      "+-1"};
    const std::size_t first = text.find_first_of("0123456789", at);
    if (first == std::string::npos) return text;
    const std::size_t last = std::min(text.size(), text.find_first_not_of("0123456789.eE+-", first));
    return text.replace(first, last - first, one_of(kNumbers));
  }

  /// Overwrites four or eight bytes with a length or a place that cannot be.
  std::string with_word(std::string text, std::size_t at) {
    static const std::vector<std::uint64_t> kWords = {0,
                                                      1,
                                                      0x7f,
                                                      0xff,
                                                      0xffff,
                                                      0x7fffffff,
                                                      0x80000000,
                                                      0xffffffff,
                                                      0x7fffffffffffffff,
                                                      0x8000000000000000,
                                                      0xffffffffffffffff};
    const std::uint64_t word = below(4) == 0 ? random_.below(UINT64_MAX) : one_of(kWords);
    for (std::size_t i = 0; i < (below(2) == 0 ? 4U : 8U) && at + i < text.size(); ++i)
      text[at + i] = static_cast<char>(word >> (8 * i));
    return text;
  }

  void change(common::Json& whole) {
    common::Json* node = &whole;
    while (node->is_structured() && !node->empty() && below(8) != 0)
      node = &std::next(node->begin(), static_cast<std::ptrdiff_t>(below(node->size()))).value();
    switch (below(4)) {
      case 0:
        if (node->is_array() && !node->empty())
          node->erase(below(node->size()));
        else if (node->is_object() && !node->empty())
          node->erase(std::next(node->begin(), static_cast<std::ptrdiff_t>(below(node->size()))).key());
        return;
      case 1:
        if (node->is_array()) node->push_back(odd());
        if (node->is_object()) (*node)[below(2) == 0 ? "\x1b[2J" : "of another version"] = odd();
        return;
      default:
        *node = odd();
    }
  }

  common::Json odd() {
    static const common::Json kOdd = {nullptr,    true,        0,
                                      -1,         1,           2147483648,
                                      1e300,      -1e300,      1e-300,
                                      0.5,        "",          "\n",
                                      "../x",     "/dev/zero", {},
                                      {{"a", 1}}, {{1, 2}},    {0, 0, 0},
                                      {-1},       {nullptr},   9223372036854775807,
                                      1e12,       "centre",    "point",
                                      8192,       {1e12},      18446744073709551615U};
    if (below(40) == 0) return std::string(10'000, 'x');
    if (below(40) == 0) return std::vector<int>(1000, 7);
    return kOdd[below(kOdd.size())];
  }

  common::RandomStream random_;
};

/// Feeds `count` inputs to `read`; `spoil(i)` makes the i-th. Counts those that are accepted, so that a case
/// can say that some are.
template <class Spoil, class Read>
std::int64_t fuzz(const Soak& soak, const Spoil& spoil, const Read& read) {
  constexpr unsigned kLongest_s = 20;
  constexpr double kMostMemory_mb = 2048.0;
  std::int64_t accepted = 0;
  for (std::int64_t i = 0; i < soak.count(); ++i) {
    spoil();
    ::alarm(kLongest_s);
    try {
      read();
      ++accepted;
    } catch (const common::Error& error) {
      if (std::string(error.what()).empty()) FAIL("an error without a word");
    } catch (const std::exception& error) {
      ::alarm(0);
      FAIL("input " << i << " of seed " << soak.seed() << ": " << error.what());
    }
    ::alarm(0);
  }
  CHECK(common::peak_memory_mb() < kMostMemory_mb);
  return accepted;
}

inline void write_bytes(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
}

}  // namespace lodestone::tests
