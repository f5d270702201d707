#pragma once

/// LibTorch's logging has a CHECK of its own, which aborts: included first, and taken back, that of Catch2 is
/// what tests mean.
#include <c10/util/Logging.h>

#undef CHECK
#include <catch2/catch.hpp>
