#pragma once

namespace lodestone::exports {

// What is the same in the header of every policy; policy_header.cpp puts constants and calls between.

constexpr const char* kHeaderBegin = R"C(
#ifndef LODESTONE_POLICY_H
#define LODESTONE_POLICY_H

#include <math.h>
#include <stdint.h>
#include <string.h>

)C";

constexpr const char* kHeaderInput = R"C(
/* Constants lie in program memory on AVR, wherever there is room, and are read by LODESTONE_READ
 * alone. Define all four to keep them elsewhere. */
#ifndef LODESTONE_READ
#ifdef __AVR__
#include <avr/pgmspace.h>
typedef uint_farptr_t lodestone_address;
#define LODESTONE_PROGRAM PROGMEM
#define LODESTONE_ADDRESS(array) pgm_get_far_address(array)
#define LODESTONE_READ(to, from, offset, bytes) memcpy_PF((to), (from) + (offset), (bytes))
#if LODESTONE_WIDEST < 512
#define LODESTONE_AVR_DOT
#endif
#else
typedef const unsigned char *lodestone_address;
#define LODESTONE_PROGRAM
#define LODESTONE_ADDRESS(array) ((const unsigned char *)(array))
#define LODESTONE_READ(to, from, offset, bytes) memcpy((to), (from) + (offset), (bytes))
#endif
#endif

/* What a decision is made from. Those that this policy does not use may hold anything. */
typedef struct {
  float x_m, y_m, heading_rad;      /* the needle as sensed */
  float target_x_m, target_y_m;     /* where the target is, or will be after the pulse */
  float target_heading_rad;         /* its own heading where any will do */
  float log_gain, log_gain_sigma;   /* how strongly this rig answers; 0, 0 where not known */
} lodestone_policy_input;
)C";

constexpr const char* kHeaderMemory = R"C(
/* What a policy remembers: all zero at the start of an episode. Whoever gives other currents than it
 * asked for writes into `action` what was given, as part of the largest current. */
typedef struct {
  float known;                /* 1 once a pose has been seen */
  float pose[3], action[2];   /* of the last decision */
)C";

constexpr const char* kHeaderStallMemory =
    R"C(  float place[3];                          /* where pulses have moved nothing, */
  float stalled[LODESTONE_STALLS][2];      /* and which, the last one first */
)C";

constexpr const char* kHeaderNetwork = R"C(} lodestone_policy_memory;

/* Rounds to 16 bits, negative numbers to 0 where asked. Returns the unit. */
static inline float lodestone_round(const float *y, int count, int relu, int16_t *x)
{
  float most = 0.0f, factor;
  int i;
  for (i = 0; i < count; ++i) {
    const float size = y[i] < 0.0f ? (relu ? 0.0f : -y[i]) : y[i];
    if (size > most) most = size;
  }
  factor = most > 1e-30f ? 32767.0f / most : 0.0f;
  for (i = 0; i < count; ++i) {
    const float number = relu && y[i] < 0.0f ? 0.0f : y[i] * factor;
    x[i] = (int16_t)(number + (number < 0.0f ? -0.5f : 0.5f));
  }
  return most / 32767.0f;
}

#ifdef LODESTONE_AVR_DOT
/* The sum of products, straight from program memory: a copy of the row would take as long again. The
 * sum has 40 bits, `low` the last eight. 43 cycles a product. */
static __attribute__((noinline, unused)) float lodestone_dot(lodestone_address row, const int16_t *x, uint16_t count)
{
  int32_t sum = 0;
  uint16_t place = (uint16_t)row;
  uint8_t low = 0, zero = 0, page = (uint8_t)(row >> 16), w_low, w_high, x_low, x_high;
  __asm__ volatile(
      "out %[rampz], %[page]\n"
      "1: elpm %[wl], Z+\n"
      "elpm %[wh], Z+\n"
      "ld %[xl], X+\n"
      "ld %[xh], X+\n"
      "muls %[wh], %[xh]\n"
      "sbc %D[sum], %[zero]\n"
      "add %B[sum], r0\n"
      "adc %C[sum], r1\n"
      "adc %D[sum], %[zero]\n"
      "mul %[wl], %[xl]\n"
      "add %[low], r0\n"
      "adc %A[sum], r1\n"
      "adc %B[sum], %[zero]\n"
      "adc %C[sum], %[zero]\n"
      "adc %D[sum], %[zero]\n"
      "mulsu %[wh], %[xl]\n"
      "sbc %C[sum], %[zero]\n"
      "sbc %D[sum], %[zero]\n"
      "add %A[sum], r0\n"
      "adc %B[sum], r1\n"
      "adc %C[sum], %[zero]\n"
      "adc %D[sum], %[zero]\n"
      "mulsu %[xh], %[wl]\n"
      "sbc %C[sum], %[zero]\n"
      "sbc %D[sum], %[zero]\n"
      "add %A[sum], r0\n"
      "adc %B[sum], r1\n"
      "adc %C[sum], %[zero]\n"
      "adc %D[sum], %[zero]\n"
      "sbiw %[count], 1\n"
      "brne 1b\n"
      "clr r1\n"
      : [sum] "+&r"(sum), [low] "+&r"(low), [x] "+&x"(x), [place] "+&z"(place), [count] "+&w"(count),
        [wl] "=&a"(w_low), [wh] "=&a"(w_high), [xl] "=&a"(x_low), [xh] "=&a"(x_high)
      : [zero] "r"(zero), [page] "r"(page), [rampz] "I"(_SFR_IO_ADDR(RAMPZ))
      : "r0", "memory");
  return 256.0f * (float)sum + (float)low;
}
#else
static inline float lodestone_dot(lodestone_address row, const int16_t *x, uint16_t count)
{
  int16_t weight[LODESTONE_WIDEST];
  int64_t sum = 0;
  uint16_t j;
  LODESTONE_READ(weight, row, 0, count * sizeof *weight);
  for (j = 0; j < count; ++j) sum += (int32_t)weight[j] * x[j];
  return (float)sum;
}
#endif

/* y += rows x, for `count` rows from `first`. */
static inline void lodestone_add(lodestone_address rows, lodestone_address scales, uint16_t first,
                                 uint16_t count, uint16_t inputs, const int16_t *x, float unit, float *y)
{
  uint16_t i;
  for (i = 0; i < count; ++i) {
    float scale;
    LODESTONE_READ(&scale, scales, (first + i) * sizeof scale, sizeof scale);
    y[first + i] += scale * unit * lodestone_dot(rows + i * inputs * sizeof *x, x, inputs);
  }
}
)C";

constexpr const char* kHeaderChoose = R"C(
/* Whether two poses are one place. */
static inline int lodestone_near(const float *one, const float *other)
{
  const float x_m = one[0] - other[0], y_m = one[1] - other[1];
  return sqrtf(x_m * x_m + y_m * y_m) < LODESTONE_STILL_M && cosf(one[2] - other[2]) > LODESTONE_STILL_COS;
}

/* Whether an action is like one that moved nothing. */
static inline int lodestone_alike(const float *action, const lodestone_policy_memory *memory)
{
  const float size = sqrtf(action[0] * action[0] + action[1] * action[1]);
  int i;
  for (i = 0; i < LODESTONE_STALLS; ++i) {
    const float *other = memory->stalled[i];
    const float x = action[0] - other[0], y = action[1] - other[1];
    const float other_size = sqrtf(other[0] * other[0] + other[1] * other[1]);
    if (sqrtf(x * x + y * y) < LODESTONE_ALIKE * (size > other_size ? size : other_size)) return 1;
  }
  return 0;
}

/* Takes in what the last action did. */
static inline void lodestone_remember(const float *pose, lodestone_policy_memory *memory)
{
  if (memory->known == 0.0f || (memory->action[0] == 0.0f && memory->action[1] == 0.0f)) return;
  if (!lodestone_near(memory->pose, memory->place)) {
    memcpy(memory->place, memory->pose, sizeof memory->place);
    memset(memory->stalled, 0, sizeof memory->stalled);
  }
  if (!lodestone_near(pose, memory->place) || lodestone_alike(memory->action, memory)) return;
  memmove(memory->stalled[1], memory->stalled[0], sizeof memory->stalled - sizeof memory->stalled[0]);
  memcpy(memory->stalled[0], memory->action, sizeof memory->action);
}

/* Proposal `k` of the network's numbers; resting behind the last. */
static inline void lodestone_propose(const float *y, int k, float *action)
{
  float size, strength;
  int i;
  action[0] = action[1] = 0.0f;
  if (k == LODESTONE_PROPOSALS) return;
  y += 3 * k;
  size = sqrtf(y[0] * y[0] + y[1] * y[1]);
  if (size < LODESTONE_LEAST_DIRECTION) size = LODESTONE_LEAST_DIRECTION;
  strength = LODESTONE_MOST_STRENGTH / (1.0f + expf(-y[2]));
  for (i = 0; i < 2; ++i) {
    const float drive = strength * y[i] / size;
    action[i] = drive < -1.0f ? -1.0f : drive > 1.0f ? 1.0f : drive;
  }
}

/* The best proposal that is not like one that moved nothing from here; the best where all are. */
static inline void lodestone_choose(const float *pose, lodestone_policy_memory *memory, const float *y,
                                    float *action)
{
  const float *score = y + 3 * LODESTONE_PROPOSALS;
  int best = 0, second = -1, k;
  lodestone_remember(pose, memory);
  for (k = 1; k <= LODESTONE_PROPOSALS; ++k)
    if (score[k] > score[best]) best = k;
  lodestone_propose(y, best, action);
  if (action[0] == 0.0f && action[1] == 0.0f) return;
  for (k = 0; k < LODESTONE_PROPOSALS; ++k) {
    lodestone_propose(y, k, action);
    if ((action[0] == 0.0f && action[1] == 0.0f) ||
        (lodestone_near(pose, memory->place) && lodestone_alike(action, memory)))
      continue;
    if (second < 0 || score[k] > score[second]) second = k;
  }
  if (second < 0) memset(memory->stalled, 0, sizeof memory->stalled);
  lodestone_propose(y, second < 0 ? best : second, action);
}
)C";

constexpr const char* kHeaderDecide = R"C(
/* Currents of the coils +x, -x, +y, -y for the next pulse, A. The memory is for the next decision. An
 * input that is not a number gives no current and is not remembered. */
static inline void lodestone_policy_decide(const lodestone_policy_input *in, lodestone_policy_memory *memory,
                                           float *current_A)
{
  const float pose[3] = {in->x_m, in->y_m, in->heading_rad};
  float y[LODESTONE_WIDEST], action[2];
  int axis;
  lodestone_encode(in, memory, y);
  memset(current_A, 0, 4 * sizeof *current_A);
  for (axis = 0; axis < LODESTONE_INPUTS; ++axis)
    if (!(fabsf(y[axis]) < 1e30f)) return;
  lodestone_network(y);
)C";

constexpr const char* kHeaderDecided = R"C(
  memory->known = 1.0f;
  memcpy(memory->pose, pose, sizeof pose);
  memcpy(memory->action, action, sizeof action);
)C";

constexpr const char* kHeaderCurrents = R"C(
  for (axis = 0; axis < 2; ++axis) {
    const float drive_A = LODESTONE_SCALE_A * action[axis];
    current_A[2 * axis] = drive_A > 0.0f ? drive_A : 0.0f;
    current_A[2 * axis + 1] = drive_A < 0.0f ? -drive_A : 0.0f;
  }
}
)C";

constexpr const char* kHeaderTest = R"C(
/* Largest difference of a current from those that Lodestone computes, A. */
static inline float lodestone_policy_test(void)
{
  lodestone_policy_memory memory;
  lodestone_policy_input in;
  float worst_A = 0.0f, current_A[4], golden_A[4];
  int step, coil;
  for (step = 0; step < LODESTONE_GOLDEN_STEPS; ++step) {
    if (step % LODESTONE_GOLDEN_EPISODE == 0) memset(&memory, 0, sizeof memory);
    LODESTONE_READ(&in, LODESTONE_ADDRESS(lodestone_golden_input), step * sizeof in, sizeof in);
    LODESTONE_READ(golden_A, LODESTONE_ADDRESS(lodestone_golden_current_A),
                   step * sizeof golden_A, sizeof golden_A);
    lodestone_policy_decide(&in, &memory, current_A);
    for (coil = 0; coil < 4; ++coil) {
      const float error_A = fabsf(current_A[coil] - golden_A[coil]);
      if (!(error_A <= worst_A)) worst_A = error_A;
    }
  }
  return worst_A;
}

#ifndef __AVR__
#include <stdio.h>

int main(void)
{
  const float worst_A = lodestone_policy_test();
  printf("currents differ from Lodestone's by %g A at most; up to %g A are rounding\n", (double)worst_A,
         (double)LODESTONE_ROUNDING_A);
  return worst_A <= LODESTONE_ROUNDING_A ? 0 : 1;
}
#endif
#endif /* LODESTONE_POLICY_TEST */
)C";

}  // namespace lodestone::exports
