/* The link to the motor controllers: sets them up, hands them the duties, reads them in turn. */
#ifndef LODESTONE_COILS_LINK_H
#define LODESTONE_COILS_LINK_H

#include "coils.h"

/* Configured, and all controllers are set up and have answered every kind of reading. */
bool coils_ready(const struct Coils* coils);
/* Repeats or gives up what was not answered in time, and sends what is most urgent. */
void coils_poll_link(struct Coils* coils);

#endif
