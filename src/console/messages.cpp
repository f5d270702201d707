#include "lodestone/console/messages.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/json.h"

namespace lodestone::console {
namespace {

using common::DataError;
using common::Json;
using geometry::Vector2;

constexpr std::size_t kLongestName = 200;
constexpr std::size_t kLongestReason = 2000;
constexpr double kBeyondImage = 1.0;  // an edge of the dish may lie outside the image

/// Members of one message, each of which is asked for once.
class Members {
 public:
  Members(const Json& json, std::string word) : json_(json), word_(std::move(word)) {}

  bool has(const char* name) const { return json_.contains(name); }
  /// Whether a member is there and null, which is then asked for.
  bool null(const char* name) {
    const bool is = has(name) && json_[name].is_null();
    asked_ += is ? 1 : 0;
    return is;
  }
  const Json& at(const char* name) {
    const auto found = json_.find(name);
    if (found == json_.end()) fail(name, "is missing");
    ++asked_;
    return *found;
  }
  bool flag(const char* name) {
    const Json& value = at(name);
    if (!value.is_boolean()) fail(name, "is not true or false");
    return value.get<bool>();
  }
  std::string text(const char* name, std::size_t longest) {
    const Json& value = at(name);
    if (!value.is_string()) fail(name, "is not a text");
    if (value.get_ref<const std::string&>().size() > longest) fail(name, "is too long");
    return value.get<std::string>();
  }
  Vector2 pair(const char* name, double least, double most) { return pair_of(at(name), name, least, most); }
  std::vector<ImagePlace> places(const char* name) {
    const Json& value = at(name);
    if (!value.is_array() || value.size() < 2 || value.size() > kMostDrawnPoints)
      fail(name, "does not have 2 to " + std::to_string(kMostDrawnPoints) + " points");
    std::vector<ImagePlace> found;
    for (const Json& point : value) found.push_back(pair_of(point, name, -kBeyondImage, 1.0 + kBeyondImage));
    return found;
  }
  ImagePlace place(const char* name) { return pair(name, -kBeyondImage, 1.0 + kBeyondImage); }
  /// All members have been asked for.
  void end() const {
    if (json_.size() != asked_ + 1) fail("a member", "is not known");
  }

 private:
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw DataError("message \"" + word_ + "\": " + name + " " + what);
  }
  Vector2 pair_of(const Json& value, const char* name, double least, double most) const {
    if (!value.is_array() || value.size() != 2 || !value[0].is_number() || !value[1].is_number())
      fail(name, "is not two numbers");
    const Vector2 found(value[0].get<double>(), value[1].get<double>());
    if (!found.allFinite() || found.minCoeff() < least || found.maxCoeff() > most)
      fail(name, "is out of range");
    return found;
  }

  const Json& json_;
  std::string word_;
  std::size_t asked_ = 0;
};

/// A stop counts whoever says it; what is told of it is one of these.
Message stop(Members& members) {
  const std::string by = members.text("by", kLongestName);
  const auto known = {"button", "space", "escape", "touch"};
  return StopAsked{std::find(known.begin(), known.end(), by) == known.end() ? "page" : by};
}
Message more(Members& members) {
  const std::string what = members.text("of", kLongestName);
  if (what == "image") return WantsImage{};
  if (what == "state") return WantsState{};
  throw DataError("message \"more\": of is neither image nor state");
}
Message beat(Members& members) {
  const bool visible = members.flag("visible");
  return Beat{visible, members.flag("focused")};
}
Message rearm(Members& members) {
  Rearm message{members.text("reason", kLongestReason), false};
  if (members.has("clears")) message.clears = members.flag("clears");
  return message;
}
Message go(Members& members) {
  Go message{members.place("to"), std::nullopt};
  if (members.has("towards")) message.towards = members.place("towards");
  return message;
}
Message draw(Members& members) {
  if (members.has("csv")) return DrawnCsv{members.text("csv", kMostMessageBytes)};
  if (members.has("shape")) return DrawnShape{members.text("shape", kLongestName)};
  DrawnStroke message{members.places("points"), false};
  if (members.has("closed")) message.closed = members.flag("closed");
  return message;
}
Message job(Members& members) {
  if (members.null("verb")) return StartJob{};
  return StartJob{members.text("verb", kLongestName)};
}

/// One word of the protocol: what it reads, and whether only the operator may say it.
struct Word {
  const char* name;
  bool needs_the_seat;
  Message (*read)(Members& members);
};

template <class Empty>
Message bare(Members&) {
  return Empty{};
}

constexpr std::array<Word, 22> kWords = {{
    {"more", false, more},
    {"beat", false, beat},
    {"stop", false, stop},
    {"operate", false, bare<Operate>},
    {"yield", true, bare<Yield>},
    {"refuse", true, bare<Refuse>},
    {"arm", true, bare<Arm>},
    {"disarm", true, bare<Disarm>},
    {"rearm", true, rearm},
    {"controller", true,
     [](Members& m) -> Message { return ChooseController{m.text("name", kLongestName)}; }},
    {"unattended", true, [](Members& m) -> Message { return Unattended{m.flag("on")}; }},
    {"go", true, go},
    {"draw", true, draw},
    {"follow", true, bare<Follow>},
    {"hand", true, [](Members& m) -> Message { return Hand{m.pair("drive", -1.0, 1.0)}; }},
    {"end", true, bare<EndRun>},
    {"place", true, bare<PlaceNeedle>},
    {"record", true, [](Members& m) -> Message { return Record{m.flag("on")}; }},
    {"runs", false, bare<ListRuns>},
    {"replay", false, [](Members& m) -> Message { return Replay{m.text("name", kLongestName)}; }},
    {"job", true, job},
    {"answer", true, [](Members& m) -> Message { return Answer{m.flag("yes")}; }},
}};

const Word& word(const std::string& name) {
  const auto found =
      std::find_if(kWords.begin(), kWords.end(), [&](const Word& w) { return name == w.name; });
  if (found == kWords.end()) throw DataError("a message whose \"do\" is not known");
  return *found;
}

}  // namespace

Message parse_message(const std::string& text) {
  if (text.size() > kMostMessageBytes) throw DataError("a message that is too long");
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("do") || !json["do"].is_string())
    throw DataError("a message that is no object with \"do\"");
  const Word& said = word(json["do"].get_ref<const std::string&>());
  Members members(json, said.name);
  Message message = said.read(members);
  members.end();
  return message;
}

const char* name_of(const Message& message) {
  return std::visit([](const auto& said) { return said.kWord; }, message);
}

bool needs_the_seat(const Message& message) { return word(name_of(message)).needs_the_seat; }

}  // namespace lodestone::console
