#pragma once

#include <pthread.h>

namespace lodestone::common {

/// Names the calling thread, for those who look at the program from outside: at most 15 letters.
inline void name_thread(const char* name) { pthread_setname_np(pthread_self(), name); }

}  // namespace lodestone::common
