/* The coil controller's behaviour, without hardware: bytes and time in, bytes out. limits.c, link.c
 * and session.c are its parts; main.c connects it to the ATmega2560; the same files run in tests on a PC. */
#ifndef LODESTONE_COILS_COILS_H
#define LODESTONE_COILS_COILS_H

#include "protocol.h"
#include "roboclaw.h"

#ifdef __cplusplus
extern "C" {
using namespace lodestone::wire;
#endif

enum { kFirmwareMajor = 1, kFirmwareMinor = 2, kFirmwarePatch = 1 };

/* What no configuration may exceed. */
enum { kHardMaxCurrent_mA = 20000, kHardMaxPulse_ms = 10000 };

/* Called by the controller to send; must not block. */
struct CoilsOutput {
  void* context;
  void (*to_host)(void* context, const uint8_t* bytes, uint8_t count);
  void (*to_controllers)(void* context, const uint8_t* bytes, uint8_t count);
};

/* One request to a motor controller and what has come back. */
struct BusTransaction {
  bool busy;
  uint8_t controller;
  uint8_t command;
  uint8_t wanted; /* bytes of the reply */
  uint8_t got;
  uint16_t crc; /* over the request, goes on over the reply */
  uint32_t sent_us;
  uint8_t reply[kMostControllers]; /* has room for kRoboClawMaxReply, too */
  /* A kDriveDuty to several controllers, which all acknowledge: a bit for each of them; 0: to one alone. */
  uint8_t together;
  int16_t duty[kMostOutputs]; /* of a kDriveDuty in flight */
};

struct MotorController {
  uint8_t setup_step; /* kSetupSteps when done */
  uint8_t unanswered; /* requests in a row */
  bool duty_known;
  int16_t duty[2];   /* acknowledged */
  bool off_repeated; /* since the last reading */
  uint8_t next_reading;
  uint8_t seen;       /* bit per kind of reading that has come since the set-up */
  bool looked;        /* its currents are known: told a short while ago, */
  uint32_t looked_us; /* then */
  uint32_t read_us;
  uint16_t supply_dV;
  int16_t board_dC;
};

/* Output i is M1 (i even) or M2 of motor controller i / 2. A coil is what one of them drives. */
struct Coils {
  struct CoilsOutput output;
  uint8_t motor_controllers; /* of the bench */
  uint8_t outputs;           /* two of each */
  uint32_t now_us;
  uint32_t tick_us; /* the last whole millisecond that has been dealt with */
  uint32_t uptime_ms;
  uint8_t reset_cause;

  struct FrameDecoder decoder;
  bool has_session;
  uint32_t session;
  uint16_t sequence; /* of the last request carried out */
  uint8_t last_reply[kMaxFrame];
  uint8_t last_reply_length;
  uint32_t heard_ms;

  bool configured;
  struct CoilLimits limits;
  struct CoilRanges ranges; /* of RANGES, or what the limits say */
  uint16_t faults;
  bool emergency_stop;

  bool pulsing;
  uint16_t pulses;
  uint32_t pulse_us; /* when it began */
  uint32_t length_us;
  int16_t target_mA[kMostOutputs];
  int16_t duty[kMostOutputs];        /* wanted */
  uint32_t changed_us[kMostOutputs]; /* when the wanted duty was last changed */
  uint32_t duty_level[kMostOutputs]; /* leaky count of on-time, 1/1000 ms */
  int16_t current_mA[kMostOutputs];
  uint16_t resistance_mohm[kMostOutputs];
  /* A steady current that waits for a fresh reading of the supply; 0: none. */
  uint16_t pending_estimate_mA[kMostOutputs];
  /* Switched off, or found with a current that nobody asked for, and not measured without one since. What a
   * motor controller acknowledges does not end this; only a measured current does. */
  bool stopping[kMostOutputs];
  uint32_t stopping_us[kMostOutputs]; /* since when */
  bool quiet;            /* nothing is said to the motor controllers, so that they stop by themselves */
  uint32_t quiet_us;     /* since when */
  bool contactor_open;   /* a coil would not switch off, or could not be looked at; until CLEAR */
  bool contactor_closed; /* told to close */
  uint32_t closed_us;    /* when */

  uint8_t trace_coil;
  uint8_t trace_count;
  struct TraceSample trace[kTraceSamples];

  struct MotorController controllers[kMostControllers];
  struct BusTransaction bus;
};

/* `motor_controllers`: 1 to kMostControllers, at addresses from kRoboClawAddress on. */
void coils_init(struct Coils* coils, struct CoilsOutput output, uint8_t motor_controllers,
                uint8_t reset_cause, bool watchdog_reset);
void coils_host_byte(struct Coils* coils, uint8_t byte);
void coils_controller_byte(struct Coils* coils, uint8_t byte);
/* Call at least once per millisecond; `now_us` counts up and wraps. */
void coils_tick(struct Coils* coils, uint32_t now_us, bool emergency_stop);
/* The contactor in the supply of the coils is to be closed: configured, all currents are known, and no coil
 * has refused to switch off. */
bool coils_contactor(const struct Coils* coils);

#ifdef __cplusplus
}
#endif

#endif
