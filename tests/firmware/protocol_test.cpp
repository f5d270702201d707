#include "coils/protocol.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using namespace lodestone;

namespace {

/// Type and number of values of each field, in the order of the wire.
using Fields = std::vector<std::pair<std::string, int>>;
#define ONE(type, name) {#type, 1},
#define MANY(type, name, count) {#type, wire::count},
// The page has the numbers of the paper's rig: two motor controllers.
constexpr int kPageControllers = 2;
#define OUTPUTS(type, name) {#type, 2 * kPageControllers},
#define CONTROLLERS(type, name) {#type, kPageControllers},

std::string documentation() {
  std::ifstream file(std::string(LODESTONE_SOURCE_DIR) + "/docs/serial-protocol.md");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The types that a piece of the page names: "u16", or "4 x i16".
Fields types_in(const std::string& text) {
  static const std::regex type(R"((?:(\d+) x )?\b([ui](?:8|16|32))\b)");
  Fields found;
  for (std::sregex_iterator at(text.begin(), text.end(), type), end; at != end; ++at)
    found.emplace_back((*at)[2], (*at)[1].matched ? std::stoi((*at)[1]) : 1);
  return found;
}

/// Cells of the table row that begins with these words.
std::vector<std::string> row(const std::string& page, const std::string& start) {
  const std::size_t begin = page.find("\n| " + start);
  REQUIRE(begin != std::string::npos);
  std::istringstream line(page.substr(begin + 2, page.find('\n', begin + 1) - begin - 2));
  std::vector<std::string> cells;
  for (std::string cell; std::getline(line, cell, '|');) cells.push_back(cell);
  return cells;
}

/// Each row of the table under a heading has the offset and the type of one field, and together they are the
/// body.
void check_table(const std::string& page, const std::string& heading, const Fields& fields, int size) {
  CAPTURE(heading);
  const std::size_t begin = page.find("### " + heading);
  REQUIRE(begin != std::string::npos);
  std::istringstream lines(page.substr(begin, page.find("\n#", begin + 1) - begin));
  static const std::regex entry(R"(\| (\d+) \|.*\|.*\|)");
  std::size_t index = 0;
  int offset = 0;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, entry)) continue;
    CAPTURE(line);
    REQUIRE(index < fields.size());
    CHECK(std::stoi(match[1]) == offset);
    const Fields named = types_in(line);
    REQUIRE(named.size() == 1);
    CHECK(named[0] == fields[index]);
    const auto& [type, count] = fields[index++];
    offset += count * std::stoi(type.substr(1)) / 8;
  }
  CHECK(index == fields.size());
  CHECK(offset == size);
}

}  // namespace

TEST_CASE("the page on the protocol names every field of every body, in order and type") {
  const std::string page = documentation();
  CHECK(types_in(row(page, "0x01 | HELLO")[2]) == Fields{HELLO_REQUEST_FIELDS(ONE, MANY)});
  CHECK(types_in(row(page, "0x01 | HELLO")[3]) == Fields{HELLO_REPLY_FIELDS(ONE, MANY)});
  CHECK(types_in(row(page, "0x03 | PULSE")[2]) == Fields{PULSE_REQUEST_FIELDS(ONE, OUTPUTS, CONTROLLERS)});
  CHECK(types_in(row(page, "0x03 | PULSE")[3]) == Fields{PULSE_REPLY_FIELDS(ONE, MANY)});
  CHECK(types_in(row(page, "0x08 | TRACE")[3]) ==
        Fields{TRACE_HEAD_FIELDS(ONE, MANY) TRACE_SAMPLE_FIELDS(ONE, MANY)});
  CHECK(types_in(row(page, "0x09 | RANGES")[2]) == Fields{COIL_RANGES_FIELDS(ONE, OUTPUTS, CONTROLLERS)});
  const std::size_t refusals = page.find("## Refusals");
  CHECK(types_in(page.substr(refusals, page.find("| reason", refusals) - refusals)) ==
        Fields{REFUSAL_FIELDS(ONE, MANY)});
  const int limits = wire::coil_limits_size(kPageControllers);
  const int state = wire::coil_state_size(kPageControllers);
  check_table(page, "Limits (CONFIGURE, " + std::to_string(limits) + " bytes)",
              {COIL_LIMITS_FIELDS(ONE, OUTPUTS, CONTROLLERS)}, limits);
  check_table(page, "State (STATUS, " + std::to_string(state) + " bytes)",
              {COIL_STATE_FIELDS(ONE, OUTPUTS, CONTROLLERS)}, state);
}

TEST_CASE("the bodies of the paper's four coils are as long as ever, and those of sixteen go into a frame") {
  CHECK(wire::coil_limits_size(2) == 28);
  CHECK(wire::pulse_request_size(2) == 10);
  CHECK(wire::coil_state_size(2) == 37);
  for (std::uint8_t controllers = 1; controllers <= wire::kMostControllers; ++controllers) {
    CAPTURE(int{controllers});
    CHECK(wire::coil_limits_size(controllers) == 16 + 6 * controllers);  // as the page says
    CHECK(wire::pulse_request_size(controllers) == 2 + 4 * controllers);
    CHECK(wire::coil_state_size(controllers) == 13 + 12 * controllers);
    CHECK(wire::coil_ranges_size(controllers) == 12 * controllers);
    CHECK(wire::coil_state_size(controllers) <= wire::kMaxBody);
    CHECK(wire::coil_ranges_size(controllers) <= wire::kMaxBody);
  }
}

TEST_CASE("a body is written byte by byte as documented, and read back") {
  const wire::PulseRequest pulse{{-2, 0x0102, 0, 15000}, 0x0304};
  std::uint8_t bytes[10];
  CHECK(wire::put_pulse_request(bytes, &pulse, 2) == bytes + sizeof bytes);
  const std::vector<std::uint8_t> expected = {0xfe, 0xff, 0x02, 0x01, 0, 0, 0x98, 0x3a, 0x04, 0x03};
  CHECK(std::vector<std::uint8_t>(bytes, bytes + sizeof bytes) == expected);
  wire::PulseRequest back{};
  CHECK(wire::get_pulse_request(bytes, &back, 2) == bytes + sizeof bytes);
  CHECK(back.current_mA[0] == -2);
  CHECK(back.length_ms == 0x0304);
}

TEST_CASE("limits, ranges and states of any number of motor controllers survive the wire") {
  // Every byte another: writing what was read gives the bytes again.
  std::uint8_t sent[wire::kMaxBody];
  for (int i = 0; i < wire::kMaxBody; ++i) sent[i] = static_cast<std::uint8_t>(0x80 + 37 * i);
  for (const int count : {1, 2, 3, 4, 8}) {
    CAPTURE(count);
    const auto controllers = static_cast<std::uint8_t>(count);
    std::uint8_t again[wire::kMaxBody] = {};
    wire::CoilLimits limits{};
    wire::get_coil_limits(sent, &limits, controllers);
    CHECK(wire::put_coil_limits(again, &limits, controllers) == again + wire::coil_limits_size(controllers));
    CHECK(std::equal(sent, sent + wire::coil_limits_size(controllers), again));
    wire::CoilRanges ranges{};
    wire::get_coil_ranges(sent, &ranges, controllers);
    CHECK(wire::put_coil_ranges(again, &ranges, controllers) == again + wire::coil_ranges_size(controllers));
    CHECK(std::equal(sent, sent + wire::coil_ranges_size(controllers), again));
    wire::CoilState state{};
    wire::get_coil_state(sent, &state, controllers);
    CHECK(wire::put_coil_state(again, &state, controllers) == again + wire::coil_state_size(controllers));
    CHECK(std::equal(sent, sent + wire::coil_state_size(controllers), again));
  }
  wire::CoilLimits limits{};
  wire::get_coil_limits(sent, &limits, 2);
  CHECK(limits.resistance_mohm[3] == (sent[18] | sent[19] << 8));
  CHECK(limits.resistance_mohm[4] == 0);
  wire::CoilState state{};
  wire::get_coil_state(sent, &state, 2);
  CHECK(state.uptime_ms ==
        (sent[3] | sent[4] << 8 | sent[5] << 16 | static_cast<std::uint32_t>(sent[6]) << 24));
  CHECK(state.board_dC[1] == static_cast<std::int16_t>(sent[29] | sent[30] << 8));
}
