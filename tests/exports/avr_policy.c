/* Runs the golden episodes of an exported policy on an ATmega2560. General-purpose registers tell the emulator: GPIOR0 1 before a
 * decision, 2 after it, 3 at the end; GPIOR1 the bytes of its currents. */
#define LODESTONE_POLICY_TEST
#include "policy.h"

#include <avr/io.h>

int main(void)
{
  static lodestone_policy_memory memory;
  lodestone_policy_input in;
  float current_A[4];
  const uint8_t *byte = (const uint8_t *)current_A;
  uint8_t step, i;
  for (step = 0; step < LODESTONE_GOLDEN_EPISODE; ++step) {
    LODESTONE_READ(&in, LODESTONE_ADDRESS(lodestone_golden_input), step * sizeof in, sizeof in);
    GPIOR0 = 1;
    lodestone_policy_decide(&in, &memory, current_A);
    GPIOR0 = 2;
    for (i = 0; i < sizeof current_A; ++i) GPIOR1 = byte[i];
  }
  GPIOR0 = 3;
  for (;;)
    ;
}
