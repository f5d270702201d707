#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::console {

/// A place in the image, as fractions of its width and height from the top left.
using ImagePlace = geometry::Vector2;

// What a page says (docs/console-protocol.md): one struct for each message.
struct WantsImage {
  static constexpr const char* kWord = "more";
};
struct WantsState {
  static constexpr const char* kWord = "more";
};
struct Beat {
  static constexpr const char* kWord = "beat";
  bool visible = false;
  bool focused = false;
};
struct StopAsked {
  static constexpr const char* kWord = "stop";
  std::string by;
};
struct Operate {
  static constexpr const char* kWord = "operate";
};
struct Yield {
  static constexpr const char* kWord = "yield";
};
struct Refuse {
  static constexpr const char* kWord = "refuse";
};
struct Arm {
  static constexpr const char* kWord = "arm";
};
struct Disarm {
  static constexpr const char* kWord = "disarm";
};
struct Rearm {
  static constexpr const char* kWord = "rearm";
  std::string reason;
  bool clears = false;
};
struct ChooseController {
  static constexpr const char* kWord = "controller";
  std::string name;
};
struct Unattended {
  static constexpr const char* kWord = "unattended";
  bool on = false;
};
struct Go {
  static constexpr const char* kWord = "go";
  ImagePlace to;
  std::optional<ImagePlace> towards;
};
struct DrawnStroke {
  static constexpr const char* kWord = "draw";
  std::vector<ImagePlace> points;
  bool closed = false;
};
struct DrawnCsv {
  static constexpr const char* kWord = "draw";
  std::string text;
};
struct DrawnShape {
  static constexpr const char* kWord = "draw";
  std::string name;
};
struct Follow {
  static constexpr const char* kWord = "follow";
};
struct Hand {
  static constexpr const char* kWord = "hand";
  geometry::Vector2 drive;
};
struct EndRun {
  static constexpr const char* kWord = "end";
};
struct PlaceNeedle {
  static constexpr const char* kWord = "place";
};
struct Record {
  static constexpr const char* kWord = "record";
  bool on = false;
};
struct ListRuns {
  static constexpr const char* kWord = "runs";
};
struct Replay {
  static constexpr const char* kWord = "replay";
  std::string name;
};
struct StartJob {
  static constexpr const char* kWord = "job";
  std::optional<std::string> verb;  ///< nothing: end the one that runs
};
struct Answer {
  static constexpr const char* kWord = "answer";
  bool yes = false;
};

using Message = std::variant<WantsImage, WantsState, Beat, StopAsked, Operate, Yield, Refuse, Arm, Disarm,
                             Rearm, ChooseController, Unattended, Go, DrawnStroke, DrawnCsv, DrawnShape,
                             Follow, Hand, EndRun, PlaceNeedle, Record, ListRuns, Replay, StartJob, Answer>;

constexpr std::size_t kMostMessageBytes = 65536;
constexpr std::size_t kMostDrawnPoints = 2000;

/// Throws DataError for whatever is not exactly a message: other members, other types, numbers that are not
/// finite or out of range, texts that are too long, points too few or too many.
Message parse_message(const std::string& text);

/// Whether only the operator's word counts.
bool needs_the_seat(const Message& message);
/// The word behind "do".
const char* name_of(const Message& message);

}  // namespace lodestone::console
