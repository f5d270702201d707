/* The wire protocol between the PC and the coil controller, shared by firmware (C) and host (C++).
 * docs/serial-protocol.md specifies it to the byte. A codec without input or output: bytes in, bytes out. */
#ifndef LODESTONE_COILS_PROTOCOL_H
#define LODESTONE_COILS_PROTOCOL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
namespace lodestone {
namespace wire {
#endif

enum {
  kProtocolVersion = 1,
  kCoils = 4,            /* +x, -x, +y, -y */
  kMaxBody = 120,        /* bytes of a message after type and sequence number */
  kOverhead = 1 + 2 + 4, /* type, sequence number, checksum */
  kMaxMessage = kMaxBody + kOverhead,
  kMaxFrame = kMaxMessage + 3, /* delimiters before and after, one code byte (messages are below 254 bytes) */
  kTraceSamples = 24,
  kHostSilenceMs = 500, /* a pulse is cut when the host has said nothing valid for so long */
};

/* Requests; the reply to a request has the same sequence number and kReply set. */
enum MessageType {
  kHello = 0x01,
  kConfigure = 0x02,
  kPulse = 0x03,
  kStop = 0x04,
  kStatus = 0x05,
  kClear = 0x06,
  kPing = 0x07,
  kTrace = 0x08,
  kReply = 0x80,
  kRefused = 0xff, /* body: type refused, RefusalReason, detail (two bytes) */
};

enum RefusalReason {
  kRefusedVersion = 1,  /* detail: the firmware's version */
  kRefusedSession = 2,  /* no HELLO since the firmware started */
  kRefusedSequence = 3, /* detail: the number expected */
  kRefusedBody = 4,     /* wrong length or unknown type */
  kRefusedLimit = 5,    /* detail: the bound that was broken (mA or ms) */
  kRefusedFault = 6,    /* detail: the latched faults */
  kRefusedSetup = 7,    /* not configured, or the motor controllers do not answer yet */
};

/* Bits of the latched faults. */
enum Fault {
  kFaultHostSilent = 1 << 0,
  kFaultControllerSilent = 1 << 1,
  kFaultOverCurrent = 1 << 2,
  kFaultStrayCurrent = 1 << 3,
  kFaultNoCurrent = 1 << 4,
  kFaultBoardHot = 1 << 5,
  kFaultCoilHot = 1 << 6,
  kFaultSupplyLow = 1 << 7,
  kFaultEmergencyStop = 1 << 8,
  kFaultDutyCycle = 1 << 9,
  kFaultWatchdog = 1 << 10,
  kFaultController = 1 << 11,
  kFaultCount = 12,
};

/* Bits of the state byte of a STATUS reply. */
enum StateBit {
  kStateSession = 1 << 0,
  kStateConfigured = 1 << 1,
  kStateReady = 1 << 2, /* the motor controllers are set up and answer */
  kStatePulsing = 1 << 3,
  kStateEmergencyStop = 1 << 4, /* the switch is open now */
};

/* Sizes of the bodies. */
enum {
  kHelloBody = 5,              /* version u8, session u32 */
  kHelloReplyBody = 12,        /* version u8, firmware major, minor, patch u8, reset cause u8, faults u16,
                                  largest current mA u16, longest pulse ms u16, controllers u8 */
  kConfigureBody = 22,         /* struct CoilLimits, in order */
  kPulseBody = 2 * kCoils + 2, /* currents mA i16 x 4, length ms u16 */
  kPulseReplyBody = 2,         /* pulses fired u16 */
  kStatusReplyBody = 37,       /* struct CoilState, in order */
  kTraceSampleBody = 4,        /* 0.1 ms since the pulse began u16, current mA i16; the body begins with
                                  the coil u8 and the number of samples u8 */
  kRefusedBodySize = 4,        /* type refused u8, RefusalReason u8, detail u16 */
};

/* CONFIGURE: what the firmware watches. */
struct CoilLimits {
  uint16_t max_current_mA;
  uint16_t max_pulse_ms;
  uint16_t max_duty_permille;       /* fraction of time that a coil may be on, */
  uint16_t duty_window_ms;          /* over about this time */
  uint16_t min_supply_dV;           /* 0.1 V */
  uint16_t max_board_dC;            /* 0.1 C */
  uint16_t resistance_mohm[kCoils]; /* of the cold coils */
  uint16_t max_resistance_permille; /* of the cold resistance: how a coil that is too hot is known */
};

/* STATUS reply. */
struct CoilState {
  uint8_t state;
  uint16_t faults;
  uint32_t uptime_ms;
  uint16_t pulses;       /* fired since the start */
  uint16_t remaining_ms; /* of the pulse */
  int16_t current_mA[kCoils];
  uint16_t resistance_mohm[kCoils]; /* as measured last */
  int16_t board_dC[2];
  uint16_t supply_dV[2];
  uint16_t resets; /* low byte: cause of the last start (MCUSR); high byte: reserved */
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
static inline uint8_t* put_u32(uint8_t* at, uint32_t value) {
  return put_u16(put_u16(at, (uint16_t)value), (uint16_t)(value >> 16));
}
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

static inline void put_limits(uint8_t* at, const struct CoilLimits* limits) {
  at = put_u16(at, limits->max_current_mA);
  at = put_u16(at, limits->max_pulse_ms);
  at = put_u16(at, limits->max_duty_permille);
  at = put_u16(at, limits->duty_window_ms);
  at = put_u16(at, limits->min_supply_dV);
  at = put_u16(at, limits->max_board_dC);
  for (uint8_t i = 0; i < kCoils; ++i) at = put_u16(at, limits->resistance_mohm[i]);
  put_u16(at, limits->max_resistance_permille);
}

static inline void get_limits(const uint8_t* at, struct CoilLimits* limits) {
  limits->max_current_mA = get_u16(at);
  limits->max_pulse_ms = get_u16(at + 2);
  limits->max_duty_permille = get_u16(at + 4);
  limits->duty_window_ms = get_u16(at + 6);
  limits->min_supply_dV = get_u16(at + 8);
  limits->max_board_dC = get_u16(at + 10);
  for (uint8_t i = 0; i < kCoils; ++i) limits->resistance_mohm[i] = get_u16(at + 12 + 2 * i);
  limits->max_resistance_permille = get_u16(at + 20);
}

static inline void put_state(uint8_t* at, const struct CoilState* state) {
  at = put_u8(at, state->state);
  at = put_u16(at, state->faults);
  at = put_u32(at, state->uptime_ms);
  at = put_u16(at, state->pulses);
  at = put_u16(at, state->remaining_ms);
  for (uint8_t i = 0; i < kCoils; ++i) at = put_u16(at, (uint16_t)state->current_mA[i]);
  for (uint8_t i = 0; i < kCoils; ++i) at = put_u16(at, state->resistance_mohm[i]);
  for (uint8_t i = 0; i < 2; ++i) at = put_u16(at, (uint16_t)state->board_dC[i]);
  for (uint8_t i = 0; i < 2; ++i) at = put_u16(at, state->supply_dV[i]);
  put_u16(at, state->resets);
}

static inline void get_state(const uint8_t* at, struct CoilState* state) {
  state->state = at[0];
  state->faults = get_u16(at + 1);
  state->uptime_ms = get_u32(at + 3);
  state->pulses = get_u16(at + 7);
  state->remaining_ms = get_u16(at + 9);
  for (uint8_t i = 0; i < kCoils; ++i) state->current_mA[i] = get_i16(at + 11 + 2 * i);
  for (uint8_t i = 0; i < kCoils; ++i) state->resistance_mohm[i] = get_u16(at + 19 + 2 * i);
  for (uint8_t i = 0; i < 2; ++i) state->board_dC[i] = get_i16(at + 27 + 2 * i);
  for (uint8_t i = 0; i < 2; ++i) state->supply_dV[i] = get_u16(at + 31 + 2 * i);
  state->resets = get_u16(at + 35);
}

#ifdef __cplusplus
}  // namespace wire
}  // namespace lodestone
#endif

#endif
