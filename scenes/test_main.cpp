// SPDX-License-Identifier: MIT
// The entry point shared by the test programs of all folders.

// gcc 12 takes Catch2's use of std::regex for reading uninitialized memory where sanitizers are on (gcc bug 105562).
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
