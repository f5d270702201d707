#include "lodestone/common/spelling.h"

#include <catch2/catch.hpp>

using namespace lodestone::common;

TEST_CASE("the word with the fewest edits is taken, the first of several") {
  CHECK(nearest_word("colect", {"calibrate", "collect", "config"}) == "collect");
  CHECK(nearest_word("depoly", {"deploy", "report"}) == "deploy");
  CHECK(nearest_word("ab", {"axb", "ayb"}) == "axb");
  CHECK(nearest_word("", {"ab"}) == "ab");
}

TEST_CASE("a word that is near none is no mistyped one") {
  CHECK(nearest_word("xyzzy", {"collect", "deploy"}).empty());
  CHECK(nearest_word("abc", {"xyz"}).empty());
  CHECK(nearest_word("collect", {}).empty());
  // Longer words may differ in more letters: under half of them.
  CHECK(nearest_word("train_dynamix", {"train-dynamics"}) == "train-dynamics");
}

TEST_CASE("a hint names the nearest word, or all of them") {
  CHECK(spelling_hint("rport", {"deploy", "report"}, "verbs") == "did you mean report?");
  CHECK(spelling_hint("fly", {"deploy", "report"}, "verbs") == "verbs are deploy, report");
}
