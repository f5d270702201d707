#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lodestone/common/config.h"

namespace lodestone::apps {

/// Where an option's value goes: a place that outlives the verb, or a function that is told the value as
/// typed (an empty text of a flag). A Text is printed, and the program ends.
struct Flag {
  std::function<void()> given;
};
struct Text {
  std::function<std::string()> printed;
};
using Target = std::variant<bool*, std::string*, std::int64_t*, double*, std::optional<std::int64_t>*,
                            std::vector<std::string>*, std::function<void(const std::string&)>, Flag, Text>;

constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// One option of a verb ("--out"), or what stands without one ("file").
struct Option {
  std::string name;
  Target target;
  std::string help;
  std::string value_name = {};  ///< "FILE"; empty: named after its type
  bool needed = false;
  bool many = false;  ///< may be given several times, with one value each
  bool shows_default = false;
  std::optional<std::pair<double, double>> bounds = {};
  std::vector<std::string> choices = {};

  Option& named(const std::string& text) { return value_name = text, *this; }
  Option& required() { return needed = true, *this; }
  Option& repeated() { return many = true, *this; }
  Option& with_default() { return shows_default = true, *this; }
  /// Without an upper bound: kNoBound.
  Option& within(double least, double most) { return bounds = {least, most}, *this; }
  Option& one_of(std::vector<std::string> words) { return choices = std::move(words), *this; }
};

/// A verb of the program as it is declared: what may stand behind it, and what it does. The parser, the
/// completion and `config --print` read the same declaration.
struct Verb {
  std::string name;
  std::string help;
  std::list<Option> options = {};
  std::list<Verb> verbs = {};
  std::function<void()> run = {};  ///< throws common::Error on faults; empty: one of its verbs must follow
  /// Every key of its configuration as the options leave it; empty: it has none.
  std::function<std::vector<common::ConfigRow>()> configuration = {};
  std::vector<std::string>* rest = nullptr;         ///< takes every word that is not an option of it
  std::map<std::string, std::string> renamed = {};  ///< names that its verbs had, and the new ones

  Verb& add_verb(const std::string& verb, const std::string& meaning) {
    return verbs.emplace_back(Verb{verb, meaning});
  }
  Option& add_option(const std::string& option, Target target, const std::string& meaning) {
    return options.emplace_back(Option{option, std::move(target), meaning});
  }
};

}  // namespace lodestone::apps
