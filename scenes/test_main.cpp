// SPDX-License-Identifier: MIT
// The entry point shared by the test programs of all folders.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
