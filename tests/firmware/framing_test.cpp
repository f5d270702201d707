#include "coils/protocol.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <iterator>
#include <random>
#include <vector>

#include "soak.h"

using namespace lodestone;

namespace {

std::vector<std::uint8_t> frame_of(std::uint8_t type, std::uint16_t sequence,
                                   const std::vector<std::uint8_t>& body) {
  wire::Message message{};
  message.type = type;
  message.sequence = sequence;
  message.length = static_cast<std::uint8_t>(body.size());
  std::copy(body.begin(), body.end(), message.body);
  std::vector<std::uint8_t> frame(wire::kMaxFrame);
  frame.resize(wire::encode_frame(&message, frame.data()));
  return frame;
}

std::vector<wire::Message> decode(wire::FrameDecoder& decoder, const std::vector<std::uint8_t>& bytes) {
  std::vector<wire::Message> found;
  for (const std::uint8_t byte : bytes) {
    wire::Message message{};
    if (wire::decode_byte(&decoder, byte, &message)) found.push_back(message);
  }
  return found;
}

std::vector<std::uint8_t> body_of(const wire::Message& message) {
  return {message.body, message.body + message.length};
}

}  // namespace

TEST_CASE("the checksum is CRC-32 of IEEE 802.3") {
  const char* text = "123456789";
  CHECK(wire::message_crc(reinterpret_cast<const std::uint8_t*>(text), 9) == 0xcbf43926u);
}

TEST_CASE("a ping is the frame that docs/serial-protocol.md shows") {
  const std::vector<std::uint8_t> frame = frame_of(wire::kPing, 0x0102, {});
  const std::vector<std::uint8_t> documented = {0x00, 0x08, 0x07, 0x02, 0x01, 0x83, 0x9d, 0x3f, 0xbf, 0x00};
  CHECK(frame == documented);
}

TEST_CASE("a pulse of the paper's four coils is the frame that it was before there were others") {
  const wire::PulseRequest pulse{{5000, 0, 0, -2000}, 100};
  std::vector<std::uint8_t> body(wire::pulse_request_size(2));
  wire::put_pulse_request(body.data(), &pulse, 2);
  const std::vector<std::uint8_t> before = {0x00, 0x06, 0x03, 0x02, 0x01, 0x88, 0x13, 0x01, 0x01, 0x01,
                                            0x04, 0x30, 0xf8, 0x64, 0x05, 0x38, 0x28, 0xf9, 0xb5, 0x00};
  CHECK(frame_of(wire::kPulse, 0x0102, body) == before);
}

TEST_CASE("pulses and states of 1, 6, 8 and 16 coils go through a frame, with currents of either sign") {
  for (const int coils : {1, 6, 8, 16}) {
    CAPTURE(coils);
    const auto controllers = static_cast<std::uint8_t>((coils + 1) / 2);
    wire::PulseRequest pulse{};
    wire::CoilState state{};
    for (int i = 0; i < coils; ++i) {
      pulse.current_mA[i] = static_cast<std::int16_t>((i % 2 == 0 ? 1 : -1) * (20000 - 256 * i));
      state.current_mA[i] = static_cast<std::int16_t>(-pulse.current_mA[i]);
      state.resistance_mohm[i] = static_cast<std::uint16_t>(60000 - i);
    }
    pulse.length_ms = 10000;
    for (int c = 0; c < controllers; ++c) state.board_dC[c] = static_cast<std::int16_t>(-c);
    std::vector<std::uint8_t> body(wire::pulse_request_size(controllers));
    wire::put_pulse_request(body.data(), &pulse, controllers);
    wire::FrameDecoder decoder{};
    auto found = decode(decoder, frame_of(wire::kPulse, 7, body));
    REQUIRE(found.size() == 1);
    REQUIRE(found.front().length == body.size());
    wire::PulseRequest got{};
    wire::get_pulse_request(found.front().body, &got, controllers);
    CHECK(std::equal(std::begin(got.current_mA), std::end(got.current_mA), std::begin(pulse.current_mA)));
    CHECK(got.length_ms == 10000);
    body.resize(wire::coil_state_size(controllers));
    wire::put_coil_state(body.data(), &state, controllers);
    found = decode(decoder, frame_of(wire::kStatus | wire::kReply, 8, body));
    REQUIRE(found.size() == 1);
    wire::CoilState told{};
    wire::get_coil_state(found.front().body, &told, controllers);
    CHECK(std::equal(std::begin(told.current_mA), std::end(told.current_mA), std::begin(state.current_mA)));
    CHECK(told.resistance_mohm[coils - 1] == 60001 - coils);
    CHECK(told.board_dC[controllers - 1] == 1 - controllers);
  }
}

TEST_CASE("messages of every length come back as they were") {
  std::mt19937 random(1);
  wire::FrameDecoder decoder{};
  for (int length = 0; length <= wire::kMaxBody; ++length) {
    for (const int kind : {0, 1, 2}) {
      std::vector<std::uint8_t> body(static_cast<std::size_t>(length));
      for (std::uint8_t& byte : body)
        byte = kind == 0 ? 0 : kind == 1 ? 0xff : static_cast<std::uint8_t>(random());
      const auto found = decode(decoder, frame_of(0x35, static_cast<std::uint16_t>(random()), body));
      REQUIRE(found.size() == 1);
      CHECK(body_of(found.front()) == body);
    }
  }
  CHECK(decoder.rejected == 0);
}

TEST_CASE("no single bit flip at any place goes unnoticed, and the next frame is read") {
  const std::vector<std::uint8_t> frame =
      frame_of(wire::kPulse, 77, {0x88, 0x13, 0, 0, 0, 0, 0x30, 0xf8, 100, 0});
  const std::vector<std::uint8_t> next = frame_of(wire::kPing, 78, {});
  for (std::size_t bit = 0; bit < 8 * frame.size(); ++bit) {
    std::vector<std::uint8_t> bytes = frame;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    bytes.insert(bytes.end(), next.begin(), next.end());
    wire::FrameDecoder decoder{};
    const auto found = decode(decoder, bytes);
    CAPTURE(bit);
    // A flip in a delimiter may leave the frame whole: the other frame's delimiter stands for it, or noise
    // that is no frame stands before it. What is read is then exactly what was sent.
    REQUIRE(found.size() <= 2);
    REQUIRE(!found.empty());
    CHECK(found.back().type == wire::kPing);
    CHECK(found.back().sequence == 78);
    if (found.size() == 2) CHECK((bit / 8 == 0 || bit / 8 == frame.size() - 1));
  }
}

TEST_CASE("frames that are cut anywhere are dropped, and the next one is read") {
  const std::vector<std::uint8_t> frame = frame_of(wire::kPulse, 77, {1, 0, 2, 0, 3, 0, 4, 0, 100, 0});
  for (std::size_t kept = 0; kept + 1 < frame.size(); ++kept) {
    std::vector<std::uint8_t> bytes(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(kept));
    const std::vector<std::uint8_t> next = frame_of(wire::kPing, 78, {});
    bytes.insert(bytes.end(), next.begin(), next.end());
    wire::FrameDecoder decoder{};
    const auto found = decode(decoder, bytes);
    CAPTURE(kept);
    REQUIRE(!found.empty());
    CHECK(found.back().sequence == 78);
    // All but the last delimiter: the next frame's first one ends it.
    CHECK(found.size() == (kept + 1 == frame.size() ? 2 : 1));
  }
}

// Chunks of noise, of frames, and of frames with noise in them.
TEST_CASE("the decoder of the host takes millions of inputs of any kind", "[soak]") {
  const tests::Soak soak("inputs of any kind into the decoder of the host", 1000000, 20000000);
  std::mt19937 random(static_cast<unsigned>(soak.seed()));
  wire::FrameDecoder decoder{};
  std::uint64_t accepted = 0;
  std::uint64_t invented = 0;
  for (std::int64_t input = 0; input < soak.count(); ++input) {
    std::uint8_t bytes[40];
    std::size_t count = random() % sizeof bytes;
    const bool framed = input % 4 == 0;
    wire::Message message{};
    if (framed) {
      message.type = static_cast<std::uint8_t>(random());
      message.sequence = static_cast<std::uint16_t>(random());
      message.length = static_cast<std::uint8_t>(random() % 24);
      for (int i = 0; i < message.length; ++i)
        message.body[i] = static_cast<std::uint8_t>(random() & random());
      std::uint8_t frame[wire::kMaxFrame];
      count = wire::encode_frame(&message, frame);
      std::copy(frame, frame + count, bytes);
      if (input % 8 == 0) bytes[random() % count] = static_cast<std::uint8_t>(random());
    } else {
      for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(random() & random());
    }
    for (std::size_t i = 0; i < count; ++i) {
      wire::Message found{};
      if (!wire::decode_byte(&decoder, bytes[i], &found)) continue;
      ++accepted;
      const bool sent = framed && found.type == message.type && found.sequence == message.sequence &&
                        found.length == message.length &&
                        std::equal(found.body, found.body + found.length, message.body);
      invented += sent ? 0 : 1;
    }
  }
  CHECK(accepted > static_cast<std::uint64_t>(soak.count() / 10));
  CHECK(invented == 0);  // by chance once in 2^32 damaged frames
}
