#include "coils.h"

#include <string.h>

enum {
  kReplyTimeout_us = 15000, /* the controllers drop a packet after a gap of 10 ms */
  kMaxTries = 3,
  kControllerTimeout_100ms = 2, /* the controllers stop by themselves after this */
  kPulseReading_us = 3000,      /* of the driven controllers, during a pulse */
  kIdleReading_us = 20000,
  kSettle_us = 60000,      /* from the end of a duty's ramp until current and duty tell the resistance, */
  kFullRamp_us = 50000,    /* which takes so long for the whole duty */
  kStray_us = 150000,      /* from switching a coil off until its current must be gone */
  kMinEstimationCurrent_mA = 1000, /* below this a resistance would be too coarse (the controllers give 10 mA) */
  kStrayCurrent_mA = 500,
};

enum SetupStep {
  kSetupTimeout,
  kSetupCheckTimeout,
  kSetupRampM1,
  kSetupRampM2,
  kSetupMaxM1,
  kSetupMaxM2,
  kSetupSteps,
};

static const uint8_t kReadings[] = {kReadCurrents, kReadMainBattery, kReadCurrents, kReadStatus,
                                    kReadCurrents, kReadTemperature};
enum { kReadingsInTurn = 6, kAllSeen = 0x0f };

static uint16_t magnitude(int16_t value) { return (uint16_t)(value < 0 ? -(int32_t)value : value); }

/* ---- pulses and faults ---- */

static void set_duty(struct Coils* coils, uint8_t coil, int16_t duty) {
  if (coils->duty[coil] == duty) return;
  coils->duty[coil] = duty;
  coils->changed_us[coil] = coils->now_us;
  coils->pending_estimate_mA[coil] = 0;
}

static void all_off(struct Coils* coils) {
  coils->pulsing = false;
  for (uint8_t i = 0; i < kCoils; ++i) {
    coils->target_mA[i] = 0;
    set_duty(coils, i, 0);
  }
}

static void latch(struct Coils* coils, uint16_t fault) {
  coils->faults |= fault;
  all_off(coils);
}

/* Voltage = current x resistance, as a fraction of the supply that is there now. */
static int16_t duty_for(const struct Coils* coils, uint8_t coil, int16_t current_mA) {
  const uint32_t supply_mV = coils->controllers[coil / 2].supply_dV * 100ul;
  uint32_t wanted_mV = (uint32_t)magnitude(current_mA) * coils->resistance_mohm[coil] / 1000;
  if (wanted_mV > supply_mV) wanted_mV = supply_mV;
  if (wanted_mV > 65000) wanted_mV = 65000;
  const int16_t duty = supply_mV == 0 ? 0 : (int16_t)(wanted_mV * kRoboClawFullDuty / supply_mV);
  return current_mA < 0 ? (int16_t)-duty : duty;
}

static bool ready(const struct Coils* coils) {
  for (uint8_t c = 0; c < kControllers; ++c) {
    const struct MotorController* controller = &coils->controllers[c];
    if (controller->setup_step != kSetupSteps || controller->seen != kAllSeen) return false;
  }
  return coils->configured;
}

static void start_pulse(struct Coils* coils, const int16_t* current_mA, uint16_t length_ms) {
  uint16_t strongest = 0;
  ++coils->pulses;
  coils->pulsing = length_ms > 0;
  coils->pulse_us = coils->now_us;
  coils->length_us = length_ms * 1000ul;
  coils->trace_count = 0;
  for (uint8_t i = 0; i < kCoils; ++i) {
    coils->target_mA[i] = coils->pulsing ? current_mA[i] : 0;
    set_duty(coils, i, duty_for(coils, i, coils->target_mA[i]));
    if (magnitude(coils->target_mA[i]) > strongest) {
      strongest = magnitude(coils->target_mA[i]);
      coils->trace_coil = i;
    }
  }
}

/* A measured current: limits and trace. */
static void take_current(struct Coils* coils, uint8_t coil, int16_t measured_mA) {
  const uint16_t size_mA = magnitude(measured_mA);
  const uint16_t target_mA = magnitude(coils->target_mA[coil]);
  const uint32_t steady_us = coils->now_us - coils->changed_us[coil];
  coils->current_mA[coil] = measured_mA;
  if (coils->pulsing && coil == coils->trace_coil && coils->trace_count < kTraceSamples) {
    const uint32_t since = (coils->now_us - coils->pulse_us) / 100;
    coils->trace_time[coils->trace_count] = since > 0xffff ? 0xffff : (uint16_t)since;
    coils->trace_mA[coils->trace_count++] = measured_mA;
  }
  if (!coils->configured) return;
  if (size_mA > (uint32_t)coils->limits.max_current_mA * 5 / 4 + 500) latch(coils, kFaultOverCurrent);
  if (target_mA == 0 && steady_us > kStray_us && size_mA > kStrayCurrent_mA) latch(coils, kFaultStrayCurrent);
  const uint32_t ramp_us = (uint32_t)magnitude(coils->duty[coil]) * (kFullRamp_us / 100) / kRoboClawFullDuty * 100;
  if (!coils->pulsing || target_mA < kMinEstimationCurrent_mA || steady_us < kSettle_us + ramp_us) return;
  if (size_mA < target_mA / 4) {
    latch(coils, kFaultNoCurrent);
    return;
  }
  coils->pending_estimate_mA[coil] = size_mA;
}

/* The resistance that duty, supply and a steady current tell together. The supply was read after the current: one
 * that has sagged is no hot coil. */
static void take_resistance(struct Coils* coils, uint8_t coil) {
  const uint16_t size_mA = coils->pending_estimate_mA[coil];
  if (size_mA == 0) return;
  coils->pending_estimate_mA[coil] = 0;
  const uint32_t drive_mV = (uint32_t)magnitude(coils->duty[coil]) * coils->controllers[coil / 2].supply_dV * 100 /
                            kRoboClawFullDuty;
  const uint32_t nominal = coils->limits.resistance_mohm[coil];
  uint32_t told = drive_mV * 1000 / size_mA;
  if (told < nominal / 2) told = nominal / 2;
  if (told > nominal * 2) told = nominal * 2;
  coils->resistance_mohm[coil] = (uint16_t)told;
  if (coils->resistance_mohm[coil] > nominal * coils->limits.max_resistance_permille / 1000)
    latch(coils, kFaultCoilHot);
  else
    set_duty(coils, coil, duty_for(coils, coil, coils->target_mA[coil]));
}

static void millisecond(struct Coils* coils) {
  ++coils->uptime_ms;
  if (!coils->configured) return;
  const uint32_t capacity = (uint32_t)coils->limits.duty_window_ms * coils->limits.max_duty_permille;
  for (uint8_t i = 0; i < kCoils; ++i) {
    uint32_t level = coils->duty_level[i] + (coils->duty[i] != 0 ? 1000 : 0);
    level = level > coils->limits.max_duty_permille ? level - coils->limits.max_duty_permille : 0;
    coils->duty_level[i] = level;
    if (level > capacity) latch(coils, kFaultDutyCycle);
  }
}

/* ---- the bus to the motor controllers ---- */

static void send_request(struct Coils* coils, uint8_t controller, uint8_t command, const uint8_t* data,
                         uint8_t count, uint8_t reply_bytes) {
  struct BusTransaction* bus = &coils->bus;
  bus->both = false;
  uint8_t packet[kRoboClawMaxRequest];
  uint8_t length = 0;
  packet[length++] = (uint8_t)(kRoboClawAddress + controller);
  packet[length++] = command;
  for (uint8_t i = 0; i < count; ++i) packet[length++] = data[i];
  uint16_t crc = 0;
  for (uint8_t i = 0; i < length; ++i) crc = roboclaw_crc(crc, packet[i]);
  bus->busy = true;
  bus->controller = controller;
  bus->command = command;
  bus->got = 0;
  bus->crc = crc;
  bus->sent_us = coils->now_us;
  bus->wanted = reply_bytes;
  if (reply_bytes == 1) { /* commands carry a checksum and are acknowledged; readings carry none */
    packet[length++] = (uint8_t)(crc >> 8);
    packet[length++] = (uint8_t)crc;
  }
  coils->output.to_controllers(coils->output.context, packet, length);
}

static void send_u32(struct Coils* coils, uint8_t controller, uint8_t command, uint32_t value, uint8_t words) {
  uint8_t data[8] = {(uint8_t)(value >> 24), (uint8_t)(value >> 16), (uint8_t)(value >> 8), (uint8_t)value};
  send_request(coils, controller, command, data, (uint8_t)(4 * words), 1);
}

static void send_setup(struct Coils* coils, uint8_t controller) {
  const uint32_t max_10mA = (uint32_t)coils->limits.max_current_mA * 5 / 40 + 50;
  const uint8_t timeout = kControllerTimeout_100ms;
  switch (coils->controllers[controller].setup_step) {
    case kSetupTimeout: send_request(coils, controller, kSetSerialTimeout, &timeout, 1, 1); break;
    case kSetupCheckTimeout: send_request(coils, controller, kReadSerialTimeout, &timeout, 0, 3); break;
    case kSetupRampM1: send_u32(coils, controller, kSetDutyRampM1, ROBOCLAW_FASTEST_RAMP, 1); break;
    case kSetupRampM2: send_u32(coils, controller, kSetDutyRampM2, ROBOCLAW_FASTEST_RAMP, 1); break;
    case kSetupMaxM1: send_u32(coils, controller, kSetMaxCurrentM1, max_10mA, 2); break;
    default: send_u32(coils, controller, kSetMaxCurrentM2, max_10mA, 2); break;
  }
}

static void send_duty(struct Coils* coils, uint8_t controller) {
  uint8_t data[4];
  for (uint8_t i = 0; i < 2; ++i) {
    const int16_t duty = coils->duty[2 * controller + i];
    coils->bus.duty[2 * controller + i] = duty;
    data[2 * i] = (uint8_t)((uint16_t)duty >> 8);
    data[2 * i + 1] = (uint8_t)duty;
  }
  send_request(coils, controller, kDriveDuty, data, 4, 1);
}

/* Both axes of a field must begin and end together: the second command follows the first without waiting, and the
 * acknowledgements come one after the other. */
static void send_both_duties(struct Coils* coils) {
  for (uint8_t c = 0; c < kControllers; ++c) send_duty(coils, c);
  coils->bus.both = true;
  coils->bus.wanted = kControllers;
}

static bool duty_differs(const struct Coils* coils, uint8_t controller) {
  const struct MotorController* c = &coils->controllers[controller];
  return !c->duty_known || c->duty[0] != coils->duty[2 * controller] || c->duty[1] != coils->duty[2 * controller + 1];
}

static bool driven(const struct Coils* coils, uint8_t controller) {
  return coils->duty[2 * controller] != 0 || coils->duty[2 * controller + 1] != 0;
}

/* What is most urgent: switching off, switching on, setting up, looking. */
static void next_transaction(struct Coils* coils) {
  const uint8_t last = coils->bus.controller;
  bool all_well = true; /* a controller that has fallen silent is spoken to alone, so that the other is not held up */
  bool all_differ = true;
  for (uint8_t c = 0; c < kControllers; ++c) {
    all_well = all_well && coils->controllers[c].duty_known && coils->controllers[c].unanswered == 0;
    all_differ = all_differ && duty_differs(coils, c);
  }
  if (all_well && all_differ) {
    send_both_duties(coils);
    return;
  }
  for (uint8_t i = 1; i <= kControllers; ++i) { /* the other one first, so that a dead one does not block it */
    const uint8_t c = (uint8_t)((last + i) % kControllers);
    if (duty_differs(coils, c) && !driven(coils, c)) {
      send_duty(coils, c);
      return;
    }
  }
  for (uint8_t c = 0; c < kControllers; ++c)
    if (duty_differs(coils, c)) {
      send_duty(coils, c);
      return;
    }
  for (uint8_t i = 1; i <= kControllers; ++i) {
    const uint8_t c = (uint8_t)((last + i) % kControllers);
    struct MotorController* controller = &coils->controllers[c];
    if (coils->configured && controller->setup_step != kSetupSteps) {
      send_setup(coils, c);
      return;
    }
    const uint32_t every_us = coils->pulsing && driven(coils, c) ? kPulseReading_us : kIdleReading_us;
    if (coils->now_us - controller->read_us < every_us) continue;
    controller->read_us = coils->now_us;
    /* During a pulse the currents matter most, and the supply once they are steady; the rest in turn. */
    const bool busy = coils->pulsing && driven(coils, c) && (coils->uptime_ms & 0x3f) > 8;
    const bool estimating = coils->pending_estimate_mA[2 * c] != 0 || coils->pending_estimate_mA[2 * c + 1] != 0;
    const uint8_t reading = busy ? (estimating ? 1 : 0) : controller->next_reading;
    if (!busy) controller->next_reading = (uint8_t)((reading + 1) % kReadingsInTurn);
    const uint8_t command = kReadings[reading];
    send_request(coils, c, command, 0, 0,
                 (uint8_t)(command == kReadCurrents || command == kReadStatus ? 6 : 4));
    return;
  }
}

static void take_reply(struct Coils* coils) {
  struct BusTransaction* bus = &coils->bus;
  struct MotorController* controller = &coils->controllers[bus->controller];
  if (bus->both) {
    bus->busy = false;
    for (uint8_t i = 0; i < 2 * kControllers; ++i) coils->controllers[i / 2].duty[i % 2] = bus->duty[i];
    return;
  }
  const uint16_t first = (uint16_t)((uint16_t)bus->reply[0] << 8 | bus->reply[1]);
  const uint16_t second = (uint16_t)((uint16_t)bus->reply[2] << 8 | bus->reply[3]);
  bus->busy = false;
  controller->unanswered = 0;
  switch (bus->command) {
    case kDriveDuty:
      controller->duty[0] = bus->duty[2 * bus->controller];
      controller->duty[1] = bus->duty[2 * bus->controller + 1];
      controller->duty_known = true;
      break;
    case kReadSerialTimeout: /* one that forgets its timeout would go on without us */
      controller->setup_step = bus->reply[0] == kControllerTimeout_100ms ? kSetupRampM1 : kSetupTimeout;
      break;
    case kReadCurrents:
      controller->seen |= 1;
      for (uint8_t i = 0; i < 2; ++i) {
        const int16_t raw_10mA = (int16_t)(i == 0 ? first : second);
        const int16_t clipped = raw_10mA > 3276 ? 3276 : raw_10mA < -3276 ? -3276 : raw_10mA;
        take_current(coils, (uint8_t)(2 * bus->controller + i), (int16_t)(clipped * 10));
      }
      break;
    case kReadMainBattery:
      controller->seen |= 2;
      controller->supply_dV = first;
      if (coils->configured && first < coils->limits.min_supply_dV) latch(coils, kFaultSupplyLow);
      for (uint8_t i = 0; i < 2; ++i) take_resistance(coils, (uint8_t)(2 * bus->controller + i));
      break;
    case kReadStatus:
      controller->seen |= 4;
      if (((uint32_t)first << 16 | second) & ROBOCLAW_STATUS_FAULTS) latch(coils, kFaultController);
      break;
    case kReadTemperature:
      controller->seen |= 8;
      controller->board_dC = (int16_t)first;
      if (coils->configured && (int16_t)first > (int16_t)coils->limits.max_board_dC) latch(coils, kFaultBoardHot);
      break;
    default: ++controller->setup_step; break;
  }
}

void coils_controller_byte(struct Coils* coils, uint8_t byte) {
  struct BusTransaction* bus = &coils->bus;
  if (!bus->busy || bus->got >= bus->wanted) return;
  bus->reply[bus->got++] = byte;
  if (bus->got < bus->wanted) return;
  if (bus->wanted == 1 || bus->both) {
    bool acknowledged = true;
    for (uint8_t i = 0; i < bus->wanted; ++i) acknowledged = acknowledged && bus->reply[i] == kRoboClawAcknowledged;
    if (acknowledged) take_reply(coils);
    return; /* anything else: the timeout repeats the request */
  }
  uint16_t crc = bus->crc;
  for (uint8_t i = 0; i + 2 < bus->wanted; ++i) crc = roboclaw_crc(crc, bus->reply[i]);
  const uint16_t sent = (uint16_t)((uint16_t)bus->reply[bus->wanted - 2] << 8 | bus->reply[bus->wanted - 1]);
  if (crc == sent) take_reply(coils);
}

static void tend_bus(struct Coils* coils) {
  struct BusTransaction* bus = &coils->bus;
  if (bus->busy) {
    if (coils->now_us - bus->sent_us < kReplyTimeout_us) return;
    struct MotorController* controller = &coils->controllers[bus->controller];
    bus->busy = false;
    if (bus->command == kDriveDuty) controller->duty_known = false; /* it may have heard us all the same */
    if (bus->both) { /* who it was shows when they are spoken to alone */
      for (uint8_t c = 0; c < kControllers; ++c) coils->controllers[c].duty_known = false;
      next_transaction(coils);
      return;
    }
    if (++controller->unanswered >= kMaxTries) {
      const bool was_ready = ready(coils);
      controller->setup_step = 0; /* it may have lost its power and with it what we set */
      controller->duty_known = false;
      controller->seen = 0;
      controller->unanswered = 0;
      if (was_ready || coils->pulsing) latch(coils, kFaultControllerSilent);
    }
  }
  next_transaction(coils);
}

/* ---- the host ---- */

static void reply(struct Coils* coils, const struct Message* message, bool keep) {
  uint8_t frame[kMaxFrame];
  const uint8_t length = encode_frame(message, frame);
  if (keep) {
    memcpy(coils->last_reply, frame, length);
    coils->last_reply_length = length;
  }
  coils->output.to_host(coils->output.context, frame, length);
}

static void refuse(struct Coils* coils, const struct Message* request, uint8_t reason, uint16_t detail, bool keep) {
  struct Message message;
  message.type = kRefused;
  message.sequence = request->sequence;
  message.length = kRefusedBodySize;
  put_u16(put_u8(put_u8(message.body, request->type), reason), detail);
  reply(coils, &message, keep);
}

static uint8_t write_state(const struct Coils* coils, uint8_t* body) {
  struct CoilState state;
  state.state = (uint8_t)((coils->has_session ? kStateSession : 0) | (coils->configured ? kStateConfigured : 0) |
                          (ready(coils) ? kStateReady : 0) | (coils->pulsing ? kStatePulsing : 0) |
                          (coils->emergency_stop ? kStateEmergencyStop : 0));
  state.faults = coils->faults;
  state.uptime_ms = coils->uptime_ms;
  state.pulses = coils->pulses;
  state.remaining_ms = 0;
  if (coils->pulsing) state.remaining_ms = (uint16_t)((coils->length_us - (coils->now_us - coils->pulse_us)) / 1000);
  for (uint8_t i = 0; i < kCoils; ++i) {
    state.current_mA[i] = coils->current_mA[i];
    state.resistance_mohm[i] = coils->resistance_mohm[i];
  }
  for (uint8_t c = 0; c < kControllers; ++c) {
    state.board_dC[c] = coils->controllers[c].board_dC;
    state.supply_dV[c] = coils->controllers[c].supply_dV;
  }
  state.resets = coils->reset_cause;
  put_state(body, &state);
  return kStatusReplyBody;
}

static void hello(struct Coils* coils, const struct Message* request) {
  if (request->length != kHelloBody) {
    refuse(coils, request, kRefusedBody, 0, false);
    return;
  }
  if (request->body[0] != kProtocolVersion) {
    refuse(coils, request, kRefusedVersion, kProtocolVersion, false);
    return;
  }
  const uint32_t session = get_u32(request->body + 1);
  if (!coils->has_session || session != coils->session) { /* not the same one repeated */
    all_off(coils);
    coils->has_session = true;
    coils->session = session;
    coils->configured = false;
  }
  coils->sequence = request->sequence;
  struct Message message;
  message.type = kHello | kReply;
  message.sequence = request->sequence;
  message.length = kHelloReplyBody;
  uint8_t* at = put_u8(message.body, kProtocolVersion);
  at = put_u8(put_u8(put_u8(at, kFirmwareMajor), kFirmwareMinor), kFirmwarePatch);
  at = put_u16(put_u8(at, coils->reset_cause), coils->faults);
  at = put_u16(put_u16(at, kHardMaxCurrent_mA), kHardMaxPulse_ms);
  put_u8(at, kControllers);
  reply(coils, &message, true);
}

static bool configure(struct Coils* coils, const struct Message* request) {
  if (request->length != kConfigureBody) {
    refuse(coils, request, kRefusedBody, 0, true);
    return false;
  }
  struct CoilLimits limits;
  get_limits(request->body, &limits);
  if (limits.max_current_mA > kHardMaxCurrent_mA) {
    refuse(coils, request, kRefusedLimit, kHardMaxCurrent_mA, true);
    return false;
  }
  if (limits.max_pulse_ms > kHardMaxPulse_ms) {
    refuse(coils, request, kRefusedLimit, kHardMaxPulse_ms, true);
    return false;
  }
  bool sound = limits.max_duty_permille <= 1000 && limits.max_resistance_permille >= 1000 &&
               limits.max_resistance_permille <= 2000;
  for (uint8_t i = 0; i < kCoils; ++i)
    sound = sound && limits.resistance_mohm[i] >= 100 && limits.resistance_mohm[i] <= 30000;
  if (!sound) {
    refuse(coils, request, kRefusedBody, 0, true);
    return false;
  }
  all_off(coils);
  for (uint8_t i = 0; i < kCoils; ++i)
    if (limits.resistance_mohm[i] != coils->limits.resistance_mohm[i])
      coils->resistance_mohm[i] = limits.resistance_mohm[i];
  coils->limits = limits;
  coils->configured = true;
  for (uint8_t c = 0; c < kControllers; ++c) {
    coils->controllers[c].setup_step = 0;
    coils->controllers[c].seen = 0;
  }
  return true;
}

static bool pulse(struct Coils* coils, const struct Message* request) {
  if (request->length != kPulseBody) {
    refuse(coils, request, kRefusedBody, 0, true);
    return false;
  }
  if (coils->faults != 0) {
    refuse(coils, request, kRefusedFault, coils->faults, true);
    return false;
  }
  if (!ready(coils)) {
    refuse(coils, request, kRefusedSetup, 0, true);
    return false;
  }
  int16_t current_mA[kCoils];
  for (uint8_t i = 0; i < kCoils; ++i) {
    current_mA[i] = get_i16(request->body + 2 * i);
    if (magnitude(current_mA[i]) > coils->limits.max_current_mA) {
      refuse(coils, request, kRefusedLimit, coils->limits.max_current_mA, true);
      return false;
    }
  }
  const uint16_t length_ms = get_u16(request->body + 2 * kCoils);
  if (length_ms > coils->limits.max_pulse_ms) {
    refuse(coils, request, kRefusedLimit, coils->limits.max_pulse_ms, true);
    return false;
  }
  start_pulse(coils, current_mA, length_ms);
  return true;
}

static uint8_t write_trace(const struct Coils* coils, uint8_t* body) {
  uint8_t* at = put_u8(put_u8(body, coils->trace_coil), coils->trace_count);
  for (uint8_t i = 0; i < coils->trace_count; ++i)
    at = put_u16(put_u16(at, coils->trace_time[i]), (uint16_t)coils->trace_mA[i]);
  return (uint8_t)(at - body);
}

static void take_message(struct Coils* coils, const struct Message* request) {
  struct Message message;
  coils->heard_ms = coils->uptime_ms;
  if (request->type == kHello) {
    hello(coils, request);
    return;
  }
  message.type = request->type | kReply;
  message.sequence = request->sequence;
  message.length = 0;
  if (request->type == kStop) { /* always obeyed, in any order, as often as it comes */
    all_off(coils);
    reply(coils, &message, false);
    return;
  }
  if (!coils->has_session) {
    refuse(coils, request, kRefusedSession, 0, false);
    return;
  }
  if (request->sequence == coils->sequence) { /* repeated: the answer was lost; nothing is done twice */
    coils->output.to_host(coils->output.context, coils->last_reply, coils->last_reply_length);
    return;
  }
  if (request->sequence != (uint16_t)(coils->sequence + 1)) {
    refuse(coils, request, kRefusedSequence, (uint16_t)(coils->sequence + 1), false);
    return;
  }
  coils->sequence = request->sequence;
  switch (request->type) {
    case kConfigure:
      if (!configure(coils, request)) return;
      break;
    case kPulse:
      if (!pulse(coils, request)) return;
      put_u16(message.body, coils->pulses);
      message.length = kPulseReplyBody;
      break;
    case kStatus: message.length = write_state(coils, message.body); break;
    case kTrace: message.length = write_trace(coils, message.body); break;
    case kClear: /* a coil that was too hot may have cooled; its next pulse tells */
      coils->faults = 0;
      for (uint8_t i = 0; i < kCoils; ++i) coils->resistance_mohm[i] = coils->limits.resistance_mohm[i];
      break;
    case kPing: break;
    default: refuse(coils, request, kRefusedBody, 0, true); return;
  }
  reply(coils, &message, true);
}

void coils_host_byte(struct Coils* coils, uint8_t byte) {
  struct Message message;
  if (decode_byte(&coils->decoder, byte, &message)) take_message(coils, &message);
}

void coils_tick(struct Coils* coils, uint32_t now_us, bool emergency_stop) {
  coils->now_us = now_us;
  while (now_us - coils->tick_us >= 1000) {
    coils->tick_us += 1000;
    millisecond(coils);
  }
  coils->emergency_stop = emergency_stop;
  if (emergency_stop) latch(coils, kFaultEmergencyStop);
  if (coils->pulsing && coils->uptime_ms - coils->heard_ms > kHostSilenceMs) latch(coils, kFaultHostSilent);
  if (coils->pulsing && now_us - coils->pulse_us >= coils->length_us) all_off(coils);
  tend_bus(coils);
}

void coils_init(struct Coils* coils, struct CoilsOutput output, uint8_t reset_cause, bool watchdog_reset) {
  memset(coils, 0, sizeof *coils);
  coils->output = output;
  coils->reset_cause = reset_cause;
  if (watchdog_reset) coils->faults = kFaultWatchdog;
}
