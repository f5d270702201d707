#include "lodestone/common/spelling.h"

#include <algorithm>
#include <numeric>

namespace lodestone::common {
namespace {

/// Levenshtein distance.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

std::string nearest_word(const std::string& typed, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(3, typed.size() / 2);
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(typed, candidate);
    if (distance >= least) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string spelling_hint(const std::string& typed, const std::vector<std::string>& known,
                          const std::string& plural, const std::string& prefix) {
  const std::string nearest = nearest_word(typed, known);
  return nearest.empty() ? plural + " are " + joined(known) : "did you mean " + prefix + nearest + "?";
}

}  // namespace lodestone::common
