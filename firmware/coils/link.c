#include "link.h"

#include "limits.h"

enum {
  kReplyTimeout_us = 15000, /* the controllers drop a packet after a gap of 10 ms */
  kMaxTries = 3,
  kControllerTimeout_100ms = 2, /* the controllers stop by themselves after this */
  kPulseReading_us = 3000,      /* of the driven controllers, during a pulse, and until a coil is seen to be off */
  kIdleReading_us = 20000,
  kQuiet_us = 400000,           /* longer than the controllers wait before they stop */
  kContactor_us = 500000,       /* until a closed contactor has let the supply rise */
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

bool coils_ready(const struct Coils* coils) {
  for (uint8_t c = 0; c < coils->motor_controllers; ++c) {
    const struct MotorController* controller = &coils->controllers[c];
    if (controller->setup_step != kSetupSteps || controller->seen != kAllSeen) return false;
  }
  return coils->configured;
}

static void send_request(struct Coils* coils, uint8_t controller, uint8_t command, const uint8_t* data,
                         uint8_t count, uint8_t reply_bytes) {
  struct BusTransaction* bus = &coils->bus;
  bus->together = 0;
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

/* Beyond it the controller switches an output off by itself, 10 mA. */
static uint32_t max_10mA(const struct Coils* coils, uint8_t output) {
  return (uint32_t)coils_most_mA(coils, output) * 5 / 40 + 50;
}

static void send_setup(struct Coils* coils, uint8_t controller) {
  const uint8_t m1 = (uint8_t)(2 * controller);
  const uint8_t timeout = kControllerTimeout_100ms;
  switch (coils->controllers[controller].setup_step) {
    case kSetupTimeout: send_request(coils, controller, kSetSerialTimeout, &timeout, 1, 1); break;
    case kSetupCheckTimeout: send_request(coils, controller, kReadSerialTimeout, &timeout, 0, 3); break;
    case kSetupRampM1: send_u32(coils, controller, kSetDutyRampM1, ROBOCLAW_FASTEST_RAMP, 1); break;
    case kSetupRampM2: send_u32(coils, controller, kSetDutyRampM2, ROBOCLAW_FASTEST_RAMP, 1); break;
    case kSetupMaxM1: send_u32(coils, controller, kSetMaxCurrentM1, max_10mA(coils, m1), 2); break;
    default: send_u32(coils, controller, kSetMaxCurrentM2, max_10mA(coils, (uint8_t)(m1 + 1)), 2); break;
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

/* All coils of a field must begin and end together: each command follows the one before without waiting, and the
 * acknowledgements come one after the other. */
static void send_duties_together(struct Coils* coils, uint8_t which) {
  uint8_t wanted = 0;
  for (uint8_t c = 0; c < coils->motor_controllers; ++c) {
    if ((which >> c & 1) == 0) continue;
    send_duty(coils, c);
    ++wanted;
  }
  coils->bus.together = which;
  coils->bus.wanted = wanted;
}

static bool duty_differs(const struct Coils* coils, uint8_t controller) {
  const struct MotorController* c = &coils->controllers[controller];
  return !c->duty_known || c->duty[0] != coils->duty[2 * controller] || c->duty[1] != coils->duty[2 * controller + 1];
}

static bool driven(const struct Coils* coils, uint8_t controller) {
  return coils->duty[2 * controller] != 0 || coils->duty[2 * controller + 1] != 0;
}

static bool stopping(const struct Coils* coils, uint8_t controller) {
  return coils->stopping[2 * controller] || coils->stopping[2 * controller + 1];
}

/* Duties that differ from what a controller has acknowledged. False: nothing to send. */
static bool send_changed_duties(struct Coils* coils) {
  uint8_t together = 0; /* one that has fallen silent is spoken to alone, so that the others are not held up */
  uint8_t count = 0;
  for (uint8_t c = 0; c < coils->motor_controllers; ++c) {
    const bool well = coils->controllers[c].duty_known && coils->controllers[c].unanswered == 0;
    if (!well || !duty_differs(coils, c)) continue;
    together = (uint8_t)(together | 1u << c);
    ++count;
  }
  if (count > 1) {
    send_duties_together(coils, together);
    return true;
  }
  const uint8_t last = coils->bus.controller;
  for (uint8_t i = 1; i <= coils->motor_controllers; ++i) { /* the others first: a dead one does not block them */
    const uint8_t c = (uint8_t)((last + i) % coils->motor_controllers);
    if (duty_differs(coils, c) && !driven(coils, c)) {
      send_duty(coils, c);
      return true;
    }
  }
  for (uint8_t c = 0; c < coils->motor_controllers; ++c)
    if (duty_differs(coils, c)) {
      send_duty(coils, c);
      return true;
    }
  return false;
}

static void send_reading(struct Coils* coils, uint8_t c) {
  struct MotorController* controller = &coils->controllers[c];
  controller->read_us = coils->now_us;
  /* During a pulse the currents matter most, and the supply once they are steady; the rest in turn. */
  const bool busy = coils->pulsing && driven(coils, c) && (coils->uptime_ms & 0x3f) > 8;
  const bool estimating = coils->pending_estimate_mA[2 * c] != 0 || coils->pending_estimate_mA[2 * c + 1] != 0;
  const bool watched = stopping(coils, c);
  const uint8_t reading = watched ? 0 : busy ? (estimating ? 1 : 0) : controller->next_reading;
  if (!busy && !watched) controller->next_reading = (uint8_t)((reading + 1) % kReadingsInTurn);
  const uint8_t command = kReadings[reading];
  send_request(coils, c, command, 0, 0, (uint8_t)(command == kReadCurrents || command == kReadStatus ? 6 : 4));
}

/* What is most urgent: switching off, switching on, setting up, looking. */
static void next_transaction(struct Coils* coils) {
  if (send_changed_duties(coils)) return;
  const uint8_t last = coils->bus.controller;
  for (uint8_t i = 1; i <= coils->motor_controllers; ++i) {
    const uint8_t c = (uint8_t)((last + i) % coils->motor_controllers);
    if (coils->configured && coils->controllers[c].setup_step != kSetupSteps) {
      send_setup(coils, c);
      return;
    }
    const bool matters = (coils->pulsing && driven(coils, c)) || stopping(coils, c);
    const uint32_t every_us = matters ? kPulseReading_us : kIdleReading_us;
    struct MotorController* controller = &coils->controllers[c];
    if (coils->now_us - controller->read_us < every_us) continue;
    if (!driven(coils, c) && !controller->off_repeated) { /* an acknowledgement may have been noise */
      send_duty(coils, c);
      controller->off_repeated = true;
      return;
    }
    controller->off_repeated = false;
    send_reading(coils, c);
    return;
  }
}

static void take_reply(struct Coils* coils) {
  struct BusTransaction* bus = &coils->bus;
  struct MotorController* controller = &coils->controllers[bus->controller];
  if (bus->together != 0) {
    bus->busy = false;
    for (uint8_t i = 0; i < coils->outputs; ++i)
      if (bus->together >> i / 2 & 1) coils->controllers[i / 2].duty[i % 2] = bus->duty[i];
    return;
  }
  const uint16_t first = (uint16_t)((uint16_t)bus->reply[0] << 8 | bus->reply[1]);
  const uint16_t second = (uint16_t)((uint16_t)bus->reply[2] << 8 | bus->reply[3]);
  bus->busy = false;
  if (bus->wanted > 1) controller->unanswered = 0; /* readings carry a checksum; an acknowledgement may be noise */
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
      controller->looked = true;
      controller->looked_us = coils->now_us;
      for (uint8_t i = 0; i < 2; ++i) {
        const int16_t raw_10mA = (int16_t)(i == 0 ? first : second);
        const int16_t clipped = raw_10mA > 3276 ? 3276 : raw_10mA < -3276 ? -3276 : raw_10mA;
        coils_take_current(coils, (uint8_t)(2 * bus->controller + i), (int16_t)(clipped * 10), bus->sent_us);
      }
      break;
    case kReadMainBattery:
      controller->supply_dV = first;
      if (!coils->configured || coils->contactor_open || first >= coils->limits.min_supply_dV)
        controller->seen |= 2; /* behind an open contactor any supply will do, so that a CLEAR can come */
      else if (coils_contactor(coils) && coils->now_us - coils->closed_us > kContactor_us)
        coils_latch(coils, kFaultSupplyLow);
      for (uint8_t i = 0; i < 2; ++i) coils_take_resistance(coils, (uint8_t)(2 * bus->controller + i));
      break;
    case kReadStatus:
      controller->seen |= 4;
      if (((uint32_t)first << 16 | second) & ROBOCLAW_STATUS_FAULTS) coils_latch(coils, kFaultController);
      break;
    case kReadTemperature:
      controller->seen |= 8;
      controller->board_dC = (int16_t)first;
      if (coils->configured && (int16_t)first > (int16_t)coils->limits.max_board_dC) coils_latch(coils, kFaultBoardHot);
      break;
    default: ++controller->setup_step; break;
  }
}

void coils_controller_byte(struct Coils* coils, uint8_t byte) {
  struct BusTransaction* bus = &coils->bus;
  if (!bus->busy || bus->got >= bus->wanted) return;
  bus->reply[bus->got++] = byte;
  if (bus->got < bus->wanted) return;
  if (bus->wanted == 1 || bus->together != 0) {
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

/* The controllers have stopped by themselves; what was told them may be forgotten. */
static void end_quiet(struct Coils* coils) {
  coils->quiet = false;
  coils->bus.busy = false;
  for (uint8_t i = 0; i < coils->outputs; ++i) coils->stopping_us[i] = coils->now_us;
  for (uint8_t c = 0; c < coils->motor_controllers; ++c) {
    coils->controllers[c].setup_step = 0;
    coils->controllers[c].duty_known = false;
    coils->controllers[c].seen = 0;
  }
}

void coils_poll_link(struct Coils* coils) {
  struct BusTransaction* bus = &coils->bus;
  if (coils->quiet) {
    if (coils->now_us - coils->quiet_us < kQuiet_us) return;
    end_quiet(coils);
  }
  if (bus->busy) {
    if (coils->now_us - bus->sent_us < kReplyTimeout_us) return;
    struct MotorController* controller = &coils->controllers[bus->controller];
    bus->busy = false;
    if (bus->command == kDriveDuty) controller->duty_known = false; /* it may have heard us all the same */
    if (bus->together != 0) { /* who it was shows when they are spoken to alone */
      for (uint8_t c = 0; c < coils->motor_controllers; ++c)
        if (bus->together >> c & 1) coils->controllers[c].duty_known = false;
      next_transaction(coils);
      return;
    }
    if (++controller->unanswered >= kMaxTries) {
      const bool was_ready = coils_ready(coils);
      controller->setup_step = 0; /* it may have lost its power and with it what we set */
      controller->duty_known = false;
      controller->seen = 0;
      controller->unanswered = 0;
      if (was_ready || coils->pulsing) coils_latch(coils, kFaultControllerSilent);
    }
  }
  next_transaction(coils);
}
