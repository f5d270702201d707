#pragma once

#include <string>
#include <vector>

namespace lodestone::common {

/// The word of `known` that `typed` was probably meant to be: the one with the smallest Levenshtein distance,
/// the first of several; empty when all are further away than 2 edits and half of its letters.
std::string nearest_word(const std::string& typed, const std::vector<std::string>& known);

/// The words with a separator between them.
std::string joined(const std::vector<std::string>& words, const char* separator = ", ");

/// "did you mean collect?", or all `known` words after "`plural` are " when none is near. `prefix` is put
/// before the word that was meant.
std::string spelling_hint(const std::string& typed, const std::vector<std::string>& known,
                          const std::string& plural, const std::string& prefix = "");

}  // namespace lodestone::common
