/* Frames on the wire between the PC and the coil controller, shared by firmware (C) and host (C++): numbers,
 * checksum, byte stuffing. Bytes in, bytes out. docs/serial-protocol.md specifies them. */
#ifndef LODESTONE_COILS_FRAMING_H
#define LODESTONE_COILS_FRAMING_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
namespace lodestone {
namespace wire {
#endif

enum {
  kMaxBody = 120,        /* bytes of a message after type and sequence number */
  kOverhead = 1 + 2 + 4, /* type, sequence number, checksum */
  kMaxMessage = kMaxBody + kOverhead,
  kMaxFrame = kMaxMessage + 3, /* delimiters before and after, one code byte (messages are below 254 bytes) */
};

/* CRC-32 (IEEE 802.3, reflected), nibble by nibble: 16 table entries. */
static inline uint32_t crc32_update(uint32_t crc, uint8_t byte) {
  static const uint32_t table[16] = {
      0x00000000u, 0x1db71064u, 0x3b6e20c8u, 0x26d930acu, 0x76dc4190u, 0x6b6b51f4u, 0x4db26158u, 0x5005713cu,
      0xedb88320u, 0xf00f9344u, 0xd6d6a3e8u, 0xcb61b38cu, 0x9b64c2b0u, 0x86d3d2d4u, 0xa00ae278u, 0xbdbdf21cu};
  crc = table[(crc ^ byte) & 0x0f] ^ (crc >> 4);
  crc = table[(crc ^ (uint8_t)(byte >> 4)) & 0x0f] ^ (crc >> 4);
  return crc;
}

static inline uint32_t message_crc(const uint8_t* bytes, uint8_t count) {
  uint32_t crc = 0xffffffffu;
  for (uint8_t i = 0; i < count; ++i) crc = crc32_update(crc, bytes[i]);
  return crc ^ 0xffffffffu;
}

/* Little-endian numbers, whatever the machine. */
static inline uint8_t* put_u8(uint8_t* at, uint8_t value) {
  *at = value;
  return at + 1;
}
static inline uint8_t* put_u16(uint8_t* at, uint16_t value) {
  return put_u8(put_u8(at, (uint8_t)value), (uint8_t)(value >> 8));
}
static inline uint8_t* put_i16(uint8_t* at, int16_t value) { return put_u16(at, (uint16_t)value); }
static inline uint8_t* put_u32(uint8_t* at, uint32_t value) {
  return put_u16(put_u16(at, (uint16_t)value), (uint16_t)(value >> 16));
}
static inline uint8_t get_u8(const uint8_t* at) { return at[0]; }
static inline uint16_t get_u16(const uint8_t* at) { return (uint16_t)(at[0] | (uint16_t)at[1] << 8); }
static inline int16_t get_i16(const uint8_t* at) { return (int16_t)get_u16(at); }
static inline uint32_t get_u32(const uint8_t* at) { return get_u16(at) | (uint32_t)get_u16(at + 2) << 16; }

struct Message {
  uint8_t type;
  uint16_t sequence;
  uint8_t length; /* of the body */
  uint8_t body[kMaxBody];
};

/* Writes a frame of at most kMaxFrame bytes: 0, the stuffed message (no zero in it), 0. Returns its length.
 */
static inline uint8_t encode_frame(const struct Message* message, uint8_t* frame) {
  uint8_t raw[kMaxMessage];
  uint8_t* end = put_u16(put_u8(raw, message->type), message->sequence);
  for (uint8_t i = 0; i < message->length; ++i) end = put_u8(end, message->body[i]);
  end = put_u32(end, message_crc(raw, (uint8_t)(end - raw)));

  uint8_t out = 0;
  frame[out++] = 0;
  uint8_t code_at = out++; /* distance from here to the next zero of the message */
  for (const uint8_t* byte = raw; byte != end; ++byte) {
    if (*byte == 0) {
      frame[code_at] = (uint8_t)(out - code_at);
      code_at = out++;
    } else {
      frame[out++] = *byte;
    }
  }
  frame[code_at] = (uint8_t)(out - code_at);
  frame[out++] = 0;
  return out;
}

/* Takes bytes one by one; after anything at all it is in step again at the next zero byte. */
struct FrameDecoder {
  uint8_t bytes[kMaxFrame];
  uint8_t length;
  bool overflow;
  uint16_t rejected; /* frames that were damaged */
};

/* True when this byte ended a whole, undamaged message, which is then in *message. */
static inline bool decode_byte(struct FrameDecoder* decoder, uint8_t byte, struct Message* message) {
  if (byte != 0) {
    if (decoder->length < kMaxMessage + 1)
      decoder->bytes[decoder->length++] = byte;
    else
      decoder->overflow = true;
    return false;
  }
  const uint8_t length = decoder->length;
  const bool overflow = decoder->overflow;
  decoder->length = 0;
  decoder->overflow = false;
  if (length == 0 && !overflow) return false; /* nothing between two delimiters */
  uint8_t raw[kMaxMessage + 1];
  uint8_t count = 0;
  bool good = !overflow;
  for (uint8_t at = 0; good && at < length;) {
    const uint8_t code = decoder->bytes[at];
    if ((uint16_t)at + code > length) {
      good = false;
      break;
    }
    for (uint8_t i = 1; i < code; ++i) raw[count++] = decoder->bytes[at + i];
    at = (uint8_t)(at + code);
    if (at < length) raw[count++] = 0;
  }
  good = good && count >= kOverhead && get_u32(raw + count - 4) == message_crc(raw, (uint8_t)(count - 4));
  if (!good) {
    ++decoder->rejected;
    return false;
  }
  message->type = raw[0];
  message->sequence = get_u16(raw + 1);
  message->length = (uint8_t)(count - kOverhead);
  for (uint8_t i = 0; i < message->length; ++i) message->body[i] = raw[3 + i];
  return true;
}

#ifdef __cplusplus
}  // namespace wire
}  // namespace lodestone
#endif

#endif
