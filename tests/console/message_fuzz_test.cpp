#include <catch2/catch.hpp>
#include <set>

#include "console/sample_messages.h"
#include "fuzz/fuzz.h"
#include "lodestone/console/messages.h"

using namespace lodestone;
using namespace lodestone::console;

namespace {

/// What has to be true of whatever was read.
struct Sane {
  void operator()(const Go& go) const {
    check(go.to.allFinite() && go.to.cwiseAbs().maxCoeff() <= 2.0);
    if (go.towards) check(go.towards->allFinite());
  }
  void operator()(const Hand& hand) const { check(hand.drive.cwiseAbs().maxCoeff() <= 1.0); }
  void operator()(const DrawnStroke& stroke) const {
    check(stroke.points.size() >= 2 && stroke.points.size() <= kMostDrawnPoints);
  }
  template <class Other>
  void operator()(const Other&) const {}

 private:
  static void check(bool sane) {
    if (!sane) FAIL("a message that was read is out of its range");
  }
};

}  // namespace

TEST_CASE("a spoiled message is refused, or read as one that keeps to its range", "[soak]") {
  const tests::Soak soak("spoiled messages", 20'000, 10'000'000);
  const std::vector<std::string> messages = tests::sample_messages();
  tests::Spoiler spoiler(soak.seed(), "messages");
  std::string text;
  std::set<std::string> words;
  std::int64_t read = 0;
  tests::fuzz(
      soak,
      [&] {
        const std::string& good = spoiler.one_of(messages);
        text = spoiler.below(2) == 0 ? spoiler.bytes(good, spoiler.one_of(messages))
                                     : spoiler.json(common::Json::parse(good))
                                           .dump(-1, ' ', false, common::Json::error_handler_t::replace);
      },
      [&] {
        const Message message = parse_message(text);
        std::visit(Sane{}, message);
        words.insert(name_of(message));
        needs_the_seat(message);
        ++read;
      });
  CHECK(read > soak.count() / 100);
  CHECK(read < soak.count());
  CHECK(words.size() > 15);
}
