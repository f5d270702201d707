#include "limits.h"

enum {
  kSettle_us = 55000, /* from a change of duty until current and duty tell the resistance, */
  kMoreOfFull_us = 20000, /* and so much longer for the whole duty, whose ramp takes 50 ms: 75 ms, within any usual pulse */
  kStray_us = 200000,    /* from switching a coil off until its current must be measured gone, */
  kDecay_us = 100000,    /* and until it is gone in a coil that obeys */
  kBlind_us = 300000,    /* without a reading of its currents a controller is not to be trusted with the supply */
  kMinEstimationCurrent_mA = 1000, /* below this a resistance would be too coarse (the controllers give 10 mA) */
  kLongAgo_us = 1l << 30, /* a quarter of the time in which the clock goes round */
  kStrayCurrent_mA = 300, /* more is a current; less may be the zero of a sensor */
};

uint16_t coils_magnitude(int16_t value) { return (uint16_t)(value < 0 ? -(int32_t)value : value); }

uint16_t coils_most_mA(const struct Coils* coils, uint8_t coil) {
  const uint16_t smallest_mA = coils_magnitude(coils->ranges.smallest_mA[coil]);
  const uint16_t largest_mA = coils_magnitude(coils->ranges.largest_mA[coil]);
  return smallest_mA > largest_mA ? smallest_mA : largest_mA;
}

static void start_stopping(struct Coils* coils, uint8_t coil) {
  if (!coils->stopping[coil]) coils->stopping_us[coil] = coils->now_us;
  coils->stopping[coil] = true;
}

static void set_duty(struct Coils* coils, uint8_t coil, int16_t duty) {
  if (coils->duty[coil] == duty) return;
  coils->duty[coil] = duty;
  coils->changed_us[coil] = coils->now_us;
  coils->pending_estimate_mA[coil] = 0;
  if (duty == 0)
    start_stopping(coils, coil);
  else if (coils->now_us - coils->stopping_us[coil] < kDecay_us)
    coils->stopping[coil] = false; /* later, a new pulse does not hide a coil that stays on between pulses */
}

void coils_all_off(struct Coils* coils) {
  coils->pulsing = false;
  for (uint8_t i = 0; i < coils->outputs; ++i) {
    coils->target_mA[i] = 0;
    set_duty(coils, i, 0);
  }
}

void coils_latch(struct Coils* coils, uint16_t fault) {
  coils->faults |= fault;
  coils_all_off(coils);
}

void coils_cut(struct Coils* coils, uint16_t fault) {
  coils_latch(coils, fault);
  coils->contactor_open = true;
  coils->contactor_closed = false;
}

void coils_allow_contactor(struct Coils* coils) {
  coils->contactor_open = false;
  for (uint8_t i = 0; i < coils->outputs; ++i) coils->stopping_us[i] = coils->now_us;
  for (uint8_t c = 0; c < coils->motor_controllers; ++c) {
    coils->controllers[c].setup_step = 0;
    coils->controllers[c].seen = 0;
  }
}

void coils_watch_contactor(struct Coils* coils) {
  bool known = true;
  for (uint8_t c = 0; c < coils->motor_controllers; ++c) {
    struct MotorController* controller = &coils->controllers[c];
    if (coils->now_us - controller->looked_us >= kBlind_us) controller->looked = false;
    known = known && controller->looked;
  }
  if (!coils->configured) {
    coils->contactor_closed = false;
  } else if (coils->contactor_closed && !known) {
    coils_cut(coils, kFaultControllerSilent);
  } else if (!coils->contactor_closed && !coils->contactor_open && known) {
    coils->contactor_closed = true;
    coils->closed_us = coils->now_us;
  }
}

void coils_watch_stopping(struct Coils* coils) {
  if (coils->quiet || !coils->configured) return;
  for (uint8_t i = 0; i < coils->outputs; ++i) {
    if (!coils->stopping[i] || coils->now_us - coils->stopping_us[i] < kStray_us) continue;
    coils_cut(coils, kFaultStrayCurrent);
    coils->quiet = true;
    coils->quiet_us = coils->now_us;
  }
}

bool coils_stopping(const struct Coils* coils) {
  bool any = false;
  for (uint8_t i = 0; i < coils->outputs; ++i) any = any || coils->stopping[i];
  return any;
}

/* Voltage = current x resistance, as a fraction of the supply that is there now. */
static int16_t duty_for(const struct Coils* coils, uint8_t coil, int16_t current_mA) {
  const uint32_t supply_mV = coils->controllers[coil / 2].supply_dV * 100ul;
  uint32_t wanted_mV = (uint32_t)coils_magnitude(current_mA) * coils->resistance_mohm[coil] / 1000;
  if (wanted_mV > supply_mV) wanted_mV = supply_mV;
  if (wanted_mV > 65000) wanted_mV = 65000;
  const int16_t duty = supply_mV == 0 ? 0 : (int16_t)(wanted_mV * kRoboClawFullDuty / supply_mV);
  return current_mA < 0 ? (int16_t)-duty : duty;
}

void coils_start_pulse(struct Coils* coils, const int16_t* current_mA, uint16_t length_ms) {
  uint16_t strongest = 0;
  ++coils->pulses;
  coils->pulsing = length_ms > 0;
  coils->pulse_us = coils->now_us;
  coils->length_us = length_ms * 1000ul;
  coils->trace_count = 0;
  for (uint8_t i = 0; i < coils->outputs; ++i) {
    coils->target_mA[i] = coils->pulsing ? current_mA[i] : 0;
    set_duty(coils, i, duty_for(coils, i, coils->target_mA[i]));
    if (coils_magnitude(coils->target_mA[i]) > strongest) {
      strongest = coils_magnitude(coils->target_mA[i]);
      coils->trace_coil = i;
    }
  }
}

/* A measured current: limits and trace. */
void coils_take_current(struct Coils* coils, uint8_t coil, int16_t measured_mA, uint32_t asked_us) {
  const uint16_t size_mA = coils_magnitude(measured_mA);
  const uint16_t target_mA = coils_magnitude(coils->target_mA[coil]);
  const uint32_t steady_us = coils->now_us - coils->changed_us[coil];
  coils->current_mA[coil] = measured_mA;
  if (coils->pulsing && coil == coils->trace_coil && coils->trace_count < kTraceSamples) {
    const uint32_t since = (coils->now_us - coils->pulse_us) / 100;
    struct TraceSample* sample = &coils->trace[coils->trace_count++];
    sample->time_100us = since > 0xffff ? 0xffff : (uint16_t)since;
    sample->current_mA = measured_mA;
  }
  if (coils->configured && size_mA > (uint32_t)coils_most_mA(coils, coil) * 5 / 4 + 500)
    coils_latch(coils, kFaultOverCurrent);
  if (coils->duty[coil] == 0) { /* looked at before CONFIGURE, too: a new session finds the coils seen off */
    if (size_mA > kStrayCurrent_mA) { /* it does not do what it acknowledged */
      start_stopping(coils, coil);
      coils->controllers[coil / 2].duty_known = false;
    } else if ((int32_t)(asked_us - coils->changed_us[coil]) > 0) {
      coils->stopping[coil] = false;
    }
    return;
  }
  const uint32_t more_us = (uint32_t)coils_magnitude(coils->duty[coil]) * (kMoreOfFull_us / 100) / kRoboClawFullDuty * 100;
  if (!coils->pulsing || target_mA < kMinEstimationCurrent_mA || steady_us < kSettle_us + more_us) return;
  if (size_mA < target_mA / 4) {
    coils_latch(coils, kFaultNoCurrent);
    return;
  }
  coils->pending_estimate_mA[coil] = size_mA;
}

/* The resistance that duty, supply and a steady current tell together. The supply was read after the current: one
 * that has sagged is no hot coil. */
void coils_take_resistance(struct Coils* coils, uint8_t coil) {
  const uint16_t size_mA = coils->pending_estimate_mA[coil];
  if (size_mA == 0) return;
  coils->pending_estimate_mA[coil] = 0;
  const uint32_t drive_mV = (uint32_t)coils_magnitude(coils->duty[coil]) * coils->controllers[coil / 2].supply_dV * 100 /
                            kRoboClawFullDuty;
  const uint32_t nominal = coils->limits.resistance_mohm[coil];
  uint32_t told = drive_mV * 1000 / size_mA;
  if (told < nominal / 2) told = nominal / 2;
  if (told > nominal * 2) told = nominal * 2;
  coils->resistance_mohm[coil] = (uint16_t)told;
  if (coils->resistance_mohm[coil] > nominal * coils->limits.max_resistance_permille / 1000)
    coils_latch(coils, kFaultCoilHot);
  else
    set_duty(coils, coil, duty_for(coils, coil, coils->target_mA[coil]));
}

void coils_take_millisecond(struct Coils* coils) {
  ++coils->uptime_ms;
  for (uint8_t i = 0; i < coils->outputs; ++i) /* a duty that is older would seem to be one to come */
    if (coils->now_us - coils->changed_us[i] > kLongAgo_us) coils->changed_us[i] = coils->now_us - kLongAgo_us;
  if (!coils->configured) return;
  const uint32_t capacity = (uint32_t)coils->limits.duty_window_ms * coils->limits.max_duty_permille;
  for (uint8_t i = 0; i < coils->outputs; ++i) {
    uint32_t level = coils->duty_level[i] + (coils->duty[i] != 0 ? 1000 : 0);
    level = level > coils->limits.max_duty_permille ? level - coils->limits.max_duty_permille : 0;
    coils->duty_level[i] = level;
    if (level > capacity) coils_latch(coils, kFaultDutyCycle);
  }
}
