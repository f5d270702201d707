/* The session with the PC: which requests are carried out, in which order, and what is answered. */
#ifndef LODESTONE_COILS_SESSION_H
#define LODESTONE_COILS_SESSION_H

#include "coils.h"

/* A whole, undamaged message of the PC. */
void coils_take_message(struct Coils* coils, const struct Message* request);

#endif
