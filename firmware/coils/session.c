#include "session.h"

#include <string.h>

#include "limits.h"
#include "link.h"

static void reply(struct Coils* coils, const struct Message* message, bool keep) {
  uint8_t frame[kMaxFrame];
  const uint8_t length = encode_frame(message, frame);
  if (keep) {
    memcpy(coils->last_reply, frame, length);
    coils->last_reply_length = length;
  }
  coils->output.to_host(coils->output.context, frame, length);
}

/* `keep`: repeated when the request is. */
static void refuse(struct Coils* coils, const struct Message* request, uint8_t reason, uint16_t detail, bool keep) {
  const struct Refusal refusal = {request->type, reason, detail};
  struct Message message;
  message.type = kRefused;
  message.sequence = request->sequence;
  message.length = kRefusalSize;
  put_refusal(message.body, &refusal);
  reply(coils, &message, keep);
}

static uint8_t write_state(const struct Coils* coils, uint8_t* body) {
  struct CoilState state;
  memset(&state, 0, sizeof state);
  state.state = (uint8_t)((coils->has_session ? kStateSession : 0) | (coils->configured ? kStateConfigured : 0) |
                          (coils_ready(coils) ? kStateReady : 0) | (coils->pulsing ? kStatePulsing : 0) |
                          (coils->emergency_stop ? kStateEmergencyStop : 0));
  state.faults = coils->faults;
  state.uptime_ms = coils->uptime_ms;
  state.pulses = coils->pulses;
  if (coils->pulsing) state.remaining_ms = (uint16_t)((coils->length_us - (coils->now_us - coils->pulse_us)) / 1000);
  for (uint8_t i = 0; i < coils->outputs; ++i) {
    state.current_mA[i] = coils->current_mA[i];
    state.resistance_mohm[i] = coils->resistance_mohm[i];
  }
  for (uint8_t c = 0; c < coils->motor_controllers; ++c) {
    state.board_dC[c] = coils->controllers[c].board_dC;
    state.supply_dV[c] = coils->controllers[c].supply_dV;
  }
  state.resets = coils->reset_cause;
  put_coil_state(body, &state, coils->motor_controllers);
  return coil_state_size(coils->motor_controllers);
}

static void hello(struct Coils* coils, const struct Message* request) {
  if (request->length != kHelloRequestSize) {
    refuse(coils, request, kRefusedBody, 0, false);
    return;
  }
  struct HelloRequest asked;
  get_hello_request(request->body, &asked);
  if (asked.version != kProtocolVersion) {
    refuse(coils, request, kRefusedVersion, kProtocolVersion, false);
    return;
  }
  if (!coils->has_session || asked.session != coils->session) { /* not the same one repeated */
    coils_all_off(coils);
    coils->has_session = true;
    coils->session = asked.session;
    coils->configured = false;
  }
  coils->sequence = request->sequence;
  const struct HelloReply answer = {kProtocolVersion,   {kFirmwareMajor, kFirmwareMinor, kFirmwarePatch},
                                    coils->reset_cause, coils->faults,
                                    kHardMaxCurrent_mA, kHardMaxPulse_ms,
                                    coils->motor_controllers};
  struct Message message;
  message.type = kHello | kReply;
  message.sequence = request->sequence;
  message.length = kHelloReplySize;
  put_hello_reply(message.body, &answer);
  reply(coils, &message, true);
}

static uint16_t bit_of(uint8_t output) { return (uint16_t)(1u << output); }

/* The handlers return 0, or why they refuse, and then perhaps a detail. */
static uint8_t configure(struct Coils* coils, const struct Message* request, uint16_t* detail) {
  if (request->length != coil_limits_size(coils->motor_controllers)) return kRefusedBody;
  struct CoilLimits limits;
  memset(&limits, 0, sizeof limits);
  get_coil_limits(request->body, &limits, coils->motor_controllers);
  if (limits.max_current_mA > kHardMaxCurrent_mA) {
    *detail = kHardMaxCurrent_mA;
    return kRefusedLimit;
  }
  if (limits.max_pulse_ms > kHardMaxPulse_ms) {
    *detail = kHardMaxPulse_ms;
    return kRefusedLimit;
  }
  bool sound = limits.max_duty_permille <= 1000 && limits.max_resistance_permille >= 1000 &&
               limits.max_resistance_permille <= 2000;
  for (uint8_t i = 0; i < coils->outputs; ++i)
    sound = sound && limits.opposite[i] < coils->outputs && limits.resistance_mohm[i] >= 100 &&
            limits.resistance_mohm[i] <= 30000;
  if (!sound) return kRefusedBody;
  coils_all_off(coils);
  for (uint8_t i = 0; i < coils->outputs; ++i) {
    if (limits.resistance_mohm[i] != coils->limits.resistance_mohm[i])
      coils->resistance_mohm[i] = limits.resistance_mohm[i];
    coils->ranges.largest_mA[i] = (int16_t)limits.max_current_mA;
    coils->ranges.smallest_mA[i] = (int16_t)-coils->ranges.largest_mA[i];
    coils->ranges.not_with[i] = limits.opposite[i] == i ? 0 : bit_of(limits.opposite[i]);
  }
  coils->limits = limits;
  coils->configured = true;
  if (!coils->contactor_open) coils_allow_contactor(coils);
  return 0;
}

/* Within the limits; the motor controllers are then told their largest currents anew. */
static uint8_t set_ranges(struct Coils* coils, const struct Message* request) {
  if (request->length != coil_ranges_size(coils->motor_controllers)) return kRefusedBody;
  if (!coils->configured) return kRefusedSetup;
  struct CoilRanges ranges;
  memset(&ranges, 0, sizeof ranges);
  get_coil_ranges(request->body, &ranges, coils->motor_controllers);
  const uint16_t all = (uint16_t)((1ul << coils->outputs) - 1);
  const uint16_t most_mA = coils->limits.max_current_mA;
  bool sound = true;
  for (uint8_t i = 0; i < coils->outputs; ++i)
    sound = sound && ranges.smallest_mA[i] <= 0 && ranges.largest_mA[i] >= 0 &&
            coils_magnitude(ranges.smallest_mA[i]) <= most_mA && coils_magnitude(ranges.largest_mA[i]) <= most_mA &&
            (ranges.not_with[i] & ~all) == 0 && (ranges.not_with[i] & bit_of(i)) == 0;
  if (!sound) return kRefusedBody;
  coils_all_off(coils);
  coils->ranges = ranges;
  if (!coils->contactor_open) coils_allow_contactor(coils);
  return 0;
}

static uint8_t pulse(struct Coils* coils, const struct Message* request, uint16_t* detail) {
  if (request->length != pulse_request_size(coils->motor_controllers)) return kRefusedBody;
  if (coils->faults != 0) {
    *detail = coils->faults;
    return kRefusedFault;
  }
  if (!coils_ready(coils)) return kRefusedSetup;
  struct PulseRequest asked;
  memset(&asked, 0, sizeof asked);
  get_pulse_request(request->body, &asked, coils->motor_controllers);
  uint16_t on = 0; /* a bit for each output */
  for (uint8_t i = 0; i < coils->outputs; ++i) {
    const int16_t current_mA = asked.current_mA[i];
    const int16_t bound_mA = current_mA < 0 ? coils->ranges.smallest_mA[i] : coils->ranges.largest_mA[i];
    if (coils_magnitude(current_mA) > coils_magnitude(bound_mA)) {
      *detail = coils_magnitude(bound_mA);
      return kRefusedLimit;
    }
    if (current_mA != 0) on |= bit_of(i);
  }
  if (asked.length_ms > coils->limits.max_pulse_ms) {
    *detail = coils->limits.max_pulse_ms;
    return kRefusedLimit;
  }
  uint32_t power_W = 0;
  for (uint8_t i = 0; i < coils->outputs; ++i) {
    if (asked.current_mA[i] != 0 && (coils->ranges.not_with[i] & on) != 0) return kRefusedOpposite;
    const uint32_t current_10mA = coils_magnitude(asked.current_mA[i]) / 10u;
    power_W += current_10mA * current_10mA / 1000 * coils->resistance_mohm[i] / 10000;
  }
  if (power_W > coils->limits.max_power_W) {
    *detail = coils->limits.max_power_W;
    return kRefusedPower;
  }
  coils_start_pulse(coils, asked.current_mA, asked.length_ms);
  return 0;
}

static uint8_t write_trace(const struct Coils* coils, uint8_t* body) {
  const struct TraceHead head = {coils->trace_coil, coils->trace_count};
  uint8_t* at = put_trace_head(body, &head);
  for (uint8_t i = 0; i < coils->trace_count; ++i) at = put_trace_sample(at, &coils->trace[i]);
  return (uint8_t)(at - body);
}

/* Carries out the next request of the session, and fills in the body of the answer. */
static uint8_t carry_out(struct Coils* coils, const struct Message* request, struct Message* answer, uint16_t* detail) {
  uint8_t refused = 0;
  switch (request->type) {
    case kConfigure: return configure(coils, request, detail);
    case kRanges: return set_ranges(coils, request);
    case kPulse:
      refused = pulse(coils, request, detail);
      if (refused == 0) {
        const struct PulseReply fired = {coils->pulses};
        answer->length = (uint8_t)(put_pulse_reply(answer->body, &fired) - answer->body);
      }
      return refused;
    case kStatus: answer->length = write_state(coils, answer->body); return 0;
    case kTrace: answer->length = write_trace(coils, answer->body); return 0;
    case kClear: /* a coil that was too hot may have cooled; its next pulse tells */
      coils->faults = coils->quiet ? kFaultStrayCurrent : 0; /* while nobody looks, nothing has changed */
      for (uint8_t i = 0; i < coils->outputs; ++i) coils->resistance_mohm[i] = coils->limits.resistance_mohm[i];
      if (coils->contactor_open && !coils->quiet) coils_allow_contactor(coils);
      return 0;
    case kPing: return 0;
    default: return kRefusedBody;
  }
}

void coils_take_message(struct Coils* coils, const struct Message* request) {
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
    coils_all_off(coils);
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
  uint16_t detail = 0;
  const uint8_t refused = carry_out(coils, request, &message, &detail);
  if (refused != 0)
    refuse(coils, request, refused, detail, true);
  else
    reply(coils, &message, true);
}
