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
  CHECK(types_in(row(page, "0x03 | PULSE")[2]) == Fields{PULSE_REQUEST_FIELDS(ONE, MANY)});
  CHECK(types_in(row(page, "0x03 | PULSE")[3]) == Fields{PULSE_REPLY_FIELDS(ONE, MANY)});
  CHECK(types_in(row(page, "0x08 | TRACE")[3]) ==
        Fields{TRACE_HEAD_FIELDS(ONE, MANY) TRACE_SAMPLE_FIELDS(ONE, MANY)});
  const std::size_t refusals = page.find("## Refusals");
  CHECK(types_in(page.substr(refusals, page.find("| reason", refusals) - refusals)) ==
        Fields{REFUSAL_FIELDS(ONE, MANY)});
  check_table(page, "Limits (CONFIGURE, " + std::to_string(wire::kCoilLimitsSize) + " bytes)",
              {COIL_LIMITS_FIELDS(ONE, MANY)}, wire::kCoilLimitsSize);
  check_table(page, "State (STATUS, " + std::to_string(wire::kCoilStateSize) + " bytes)",
              {COIL_STATE_FIELDS(ONE, MANY)}, wire::kCoilStateSize);
}

TEST_CASE("a body is written byte by byte as documented, and read back") {
  const wire::PulseRequest pulse{{-2, 0x0102, 0, 15000}, 0x0304};
  std::uint8_t bytes[wire::kPulseRequestSize];
  CHECK(wire::put_pulse_request(bytes, &pulse) == bytes + wire::kPulseRequestSize);
  const std::vector<std::uint8_t> expected = {0xfe, 0xff, 0x02, 0x01, 0, 0, 0x98, 0x3a, 0x04, 0x03};
  CHECK(std::vector<std::uint8_t>(bytes, bytes + sizeof bytes) == expected);
  wire::PulseRequest back{};
  CHECK(wire::get_pulse_request(bytes, &back) == bytes + wire::kPulseRequestSize);
  CHECK(back.current_mA[0] == -2);
  CHECK(back.length_ms == 0x0304);
}

TEST_CASE("limits and states survive the wire") {
  // Every byte another: writing what was read gives the bytes again.
  std::uint8_t sent[wire::kMaxBody];
  for (int i = 0; i < wire::kMaxBody; ++i) sent[i] = static_cast<std::uint8_t>(0x80 + 37 * i);
  std::uint8_t again[wire::kMaxBody] = {};
  wire::CoilLimits limits{};
  wire::get_coil_limits(sent, &limits);
  wire::put_coil_limits(again, &limits);
  CHECK(std::equal(sent, sent + wire::kCoilLimitsSize, again));
  CHECK(limits.resistance_mohm[3] == (sent[18] | sent[19] << 8));
  wire::CoilState state{};
  wire::get_coil_state(sent, &state);
  wire::put_coil_state(again, &state);
  CHECK(std::equal(sent, sent + wire::kCoilStateSize, again));
  CHECK(state.uptime_ms ==
        (sent[3] | sent[4] << 8 | sent[5] << 16 | static_cast<std::uint32_t>(sent[6]) << 24));
  CHECK(state.board_dC[1] == static_cast<std::int16_t>(sent[29] | sent[30] << 8));
}
