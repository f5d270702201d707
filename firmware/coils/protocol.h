/* What the PC and the coil controller say to each other, shared by firmware (C) and host (C++).
 * docs/serial-protocol.md specifies it to the byte. One list of fields makes each body: its struct, its size,
 * and how it is written and read. Some have a number for each output, or for each motor controller, of which
 * a firmware is built for 1 to 8; with two of them, the bodies are those of the paper's four coils. */
#ifndef LODESTONE_COILS_PROTOCOL_H
#define LODESTONE_COILS_PROTOCOL_H

#include "framing.h"
#include "wire_body.h"

#ifdef __cplusplus
namespace lodestone {
namespace wire {
#endif

enum {
  kProtocolVersion = 2,
  kMostControllers = 8,                /* motor controllers, of two outputs each */
  kMostOutputs = 2 * kMostControllers, /* each for a coil */
  kTraceSamples = 24,
  kVersionNumbers = 3,  /* of the firmware: major, minor, patch */
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
  kRanges = 0x09,
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
  kRefusedOpposite = 8, /* two coils that may not be on together */
  kRefusedPower = 9,    /* detail: the bound that was broken (W) */
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

/* The bodies, field by field in the order of the wire: ONE(type, name), MANY(type, name, how many); of those
 * that depend on the bench ONE(type, name), OUTPUTS(type, name) for each output, CONTROLLERS(type, name). */
#define HELLO_REQUEST_FIELDS(ONE, MANY) \
  ONE(u8, version)                      \
  ONE(u32, session) /* random; a new one starts a new session */

#define HELLO_REPLY_FIELDS(ONE, MANY)                           \
  ONE(u8, version)                                              \
  MANY(u8, firmware, kVersionNumbers) /* major, minor, patch */ \
  ONE(u8, reset_cause)                                          \
  ONE(u16, faults)                                              \
  ONE(u16, max_current_mA)                                      \
  ONE(u16, max_pulse_ms)                                        \
  ONE(u8, controllers)

/* CONFIGURE: what the firmware watches. */
#define COIL_LIMITS_FIELDS(ONE, OUTPUTS, CONTROLLERS)                                        \
  ONE(u16, max_current_mA)                                                                   \
  ONE(u16, max_pulse_ms)                                                                     \
  ONE(u16, max_duty_permille)       /* fraction of time that a coil may be on, */            \
  ONE(u16, duty_window_ms)          /* over about this time */                               \
  ONE(u16, min_supply_dV)           /* 0.1 V */                                              \
  ONE(u16, max_board_dC)            /* 0.1 C */                                              \
  OUTPUTS(u16, resistance_mohm)     /* of the cold coils */                                  \
  ONE(u16, max_power_W)             /* of all coils together */                              \
  OUTPUTS(u8, opposite)             /* which may not be on with this one; itself: any may */ \
  ONE(u16, max_resistance_permille) /* of the cold resistance: how a coil that is too hot is known */

/* RANGES: what CONFIGURE has no room for, where coils differ. */
#define COIL_RANGES_FIELDS(ONE, OUTPUTS, CONTROLLERS)                 \
  OUTPUTS(i16, smallest_mA) /* 0: of one sign only, as it is wired */ \
  OUTPUTS(i16, largest_mA)                                            \
  OUTPUTS(u16, not_with) /* a bit for each output that may not be on with it */

#define PULSE_REQUEST_FIELDS(ONE, OUTPUTS, CONTROLLERS) \
  OUTPUTS(i16, current_mA)                              \
  ONE(u16, length_ms)

#define PULSE_REPLY_FIELDS(ONE, MANY) ONE(u16, pulses) /* fired since the start */

/* STATUS reply. */
#define COIL_STATE_FIELDS(ONE, OUTPUTS, CONTROLLERS)   \
  ONE(u8, state) /* StateBit */                        \
  ONE(u16, faults)                                     \
  ONE(u32, uptime_ms)                                  \
  ONE(u16, pulses)       /* fired since the start */   \
  ONE(u16, remaining_ms) /* of the pulse */            \
  OUTPUTS(i16, current_mA)                             \
  OUTPUTS(u16, resistance_mohm) /* as measured last */ \
  CONTROLLERS(i16, board_dC)                           \
  CONTROLLERS(u16, supply_dV)                          \
  ONE(u16, resets) /* low byte: cause of the last start (MCUSR); high byte: reserved */

/* TRACE reply: this, and then `count` samples. */
#define TRACE_HEAD_FIELDS(ONE, MANY) \
  ONE(u8, coil)                      \
  ONE(u8, count)

#define TRACE_SAMPLE_FIELDS(ONE, MANY)             \
  ONE(u16, time_100us) /* since the pulse began */ \
  ONE(i16, current_mA)

/* Body of kRefused. */
#define REFUSAL_FIELDS(ONE, MANY)        \
  ONE(u8, type)   /* that was refused */ \
  ONE(u8, reason) /* RefusalReason */    \
  ONE(u16, detail)

WIRE_BODY(HelloRequest, hello_request, HELLO_REQUEST_FIELDS)
WIRE_BODY(HelloReply, hello_reply, HELLO_REPLY_FIELDS)
WIRE_BENCH_BODY(CoilLimits, coil_limits, COIL_LIMITS_FIELDS)
WIRE_BENCH_BODY(CoilRanges, coil_ranges, COIL_RANGES_FIELDS)
WIRE_BENCH_BODY(PulseRequest, pulse_request, PULSE_REQUEST_FIELDS)
WIRE_BODY(PulseReply, pulse_reply, PULSE_REPLY_FIELDS)
WIRE_BENCH_BODY(CoilState, coil_state, COIL_STATE_FIELDS)
WIRE_BODY(TraceHead, trace_head, TRACE_HEAD_FIELDS)
WIRE_BODY(TraceSample, trace_sample, TRACE_SAMPLE_FIELDS)
WIRE_BODY(Refusal, refusal, REFUSAL_FIELDS)

#ifdef __cplusplus
}  // namespace wire
}  // namespace lodestone
#endif

#endif
