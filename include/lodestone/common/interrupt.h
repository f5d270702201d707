#pragma once

namespace lodestone::common {

/// From here on Ctrl-C and SIGTERM set a flag instead of ending the program; a second Ctrl-C ends it at once.
void install_interrupt_handler();

/// True once the user asked to stop. Long loops look, save a checkpoint and throw Interrupted.
bool interrupted() noexcept;

}  // namespace lodestone::common
