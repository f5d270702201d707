#include "coils.h"

#include <string.h>

#include "limits.h"
#include "link.h"
#include "session.h"

void coils_host_byte(struct Coils* coils, uint8_t byte) {
  struct Message message;
  if (decode_byte(&coils->decoder, byte, &message)) coils_take_message(coils, &message);
}

void coils_tick(struct Coils* coils, uint32_t now_us, bool emergency_stop) {
  coils->now_us = now_us;
  /* Signed: a clock that goes back a little would otherwise count for an hour. */
  while ((int32_t)(now_us - coils->tick_us) >= 1000) {
    coils->tick_us += 1000;
    coils_take_millisecond(coils);
  }
  coils->emergency_stop = emergency_stop;
  if (emergency_stop) coils_cut(coils, kFaultEmergencyStop);
  /* A pulse that a fault has ended may not have ended yet. */
  const bool may_flow = coils->pulsing || (coils->faults != 0 && coils_stopping(coils));
  if (may_flow && coils->uptime_ms - coils->heard_ms > kHostSilenceMs) coils_cut(coils, kFaultHostSilent);
  if (coils->pulsing && now_us - coils->pulse_us >= coils->length_us) coils_all_off(coils);
  coils_watch_stopping(coils);
  coils_watch_contactor(coils);
  coils_poll_link(coils);
}

bool coils_contactor(const struct Coils* coils) { return coils->configured && coils->contactor_closed; }

void coils_init(struct Coils* coils, struct CoilsOutput output, uint8_t motor_controllers, uint8_t reset_cause,
                bool watchdog_reset) {
  memset(coils, 0, sizeof *coils);
  coils->output = output;
  coils->motor_controllers = motor_controllers;
  coils->outputs = (uint8_t)(2 * motor_controllers);
  coils->reset_cause = reset_cause;
  if (watchdog_reset) coils->faults = kFaultWatchdog;
}
