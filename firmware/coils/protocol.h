/* What the PC and the coil controller say to each other, shared by firmware (C) and host (C++).
 * docs/serial-protocol.md specifies it to the byte. One list of fields makes each body: its struct, its size,
 * and how it is written and read. */
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
  kCoils = 4,       /* +x, -x, +y, -y */
  kControllers = 2, /* motor controllers, of two coils each */
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
  kRefusedOpposite = 8, /* both coils of an opposed pair */
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

/* The bodies, field by field in the order of the wire: ONE(type, name), MANY(type, name, how many). */
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
#define COIL_LIMITS_FIELDS(ONE, MANY)                                                          \
  ONE(u16, max_current_mA)                                                                     \
  ONE(u16, max_pulse_ms)                                                                       \
  ONE(u16, max_duty_permille)        /* fraction of time that a coil may be on, */             \
  ONE(u16, duty_window_ms)           /* over about this time */                                \
  ONE(u16, min_supply_dV)            /* 0.1 V */                                               \
  ONE(u16, max_board_dC)             /* 0.1 C */                                               \
  MANY(u16, resistance_mohm, kCoils) /* of the cold coils */                                   \
  ONE(u16, max_power_W)              /* of all coils together */                               \
  MANY(u8, opposite, kCoils)         /* which coil may not be on with this; itself: any may */ \
  ONE(u16, max_resistance_permille)  /* of the cold resistance: how a coil that is too hot is known */

#define PULSE_REQUEST_FIELDS(ONE, MANY) \
  MANY(i16, current_mA, kCoils)         \
  ONE(u16, length_ms)

#define PULSE_REPLY_FIELDS(ONE, MANY) ONE(u16, pulses) /* fired since the start */

/* STATUS reply. */
#define COIL_STATE_FIELDS(ONE, MANY)                        \
  ONE(u8, state) /* StateBit */                             \
  ONE(u16, faults)                                          \
  ONE(u32, uptime_ms)                                       \
  ONE(u16, pulses)       /* fired since the start */        \
  ONE(u16, remaining_ms) /* of the pulse */                 \
  MANY(i16, current_mA, kCoils)                             \
  MANY(u16, resistance_mohm, kCoils) /* as measured last */ \
  MANY(i16, board_dC, kControllers)                         \
  MANY(u16, supply_dV, kControllers)                        \
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
WIRE_BODY(CoilLimits, coil_limits, COIL_LIMITS_FIELDS)
WIRE_BODY(PulseRequest, pulse_request, PULSE_REQUEST_FIELDS)
WIRE_BODY(PulseReply, pulse_reply, PULSE_REPLY_FIELDS)
WIRE_BODY(CoilState, coil_state, COIL_STATE_FIELDS)
WIRE_BODY(TraceHead, trace_head, TRACE_HEAD_FIELDS)
WIRE_BODY(TraceSample, trace_sample, TRACE_SAMPLE_FIELDS)
WIRE_BODY(Refusal, refusal, REFUSAL_FIELDS)

#ifdef __cplusplus
}  // namespace wire
}  // namespace lodestone
#endif

#endif
