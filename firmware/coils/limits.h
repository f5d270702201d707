/* What the coils are asked for and what switches them off: pulses, limits, latched faults. */
#ifndef LODESTONE_COILS_LIMITS_H
#define LODESTONE_COILS_LIMITS_H

#include "coils.h"

uint16_t coils_magnitude(int16_t value);
/* Largest current that a coil may have, of either sign. */
uint16_t coils_most_mA(const struct Coils* coils, uint8_t coil);
void coils_all_off(struct Coils* coils);
/* Keeps the faults and switches off. */
void coils_latch(struct Coils* coils, uint16_t faults);
/* The same, and opens the contactor until CLEAR: for what must not wait until a motor controller has obeyed.
 */
void coils_cut(struct Coils* coils, uint16_t faults);
/* The contactor may close (again), and the motor controllers are set up anew. */
void coils_allow_contactor(struct Coils* coils);
/* A length of 0 switches off. The currents are within the limits. */
void coils_start_pulse(struct Coils* coils, const int16_t* current_mA, uint16_t length_ms);
/* A coil that is still not measured without current too long after it was switched off: the controllers are
 * left alone until they stop by themselves, and the contactor opens. */
void coils_watch_stopping(struct Coils* coils);
/* A coil has been switched off and not been measured without current since. */
bool coils_stopping(const struct Coils* coils);
/* Closes the contactor once all currents are known, and opens it when one is not known for too long: an
 * output that stuck then would go unseen. */
void coils_watch_contactor(struct Coils* coils);
/* A measured current, asked for at `asked_us`: limits and trace. */
void coils_take_current(struct Coils* coils, uint8_t coil, int16_t measured_mA, uint32_t asked_us);
/* A fresh reading of the supply: what it and the last steady current tell of the resistance. */
void coils_take_resistance(struct Coils* coils, uint8_t coil);
/* A millisecond has passed: counts the time switched on. */
void coils_take_millisecond(struct Coils* coils);

#endif
