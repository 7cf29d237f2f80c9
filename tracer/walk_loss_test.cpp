// SPDX-License-Identifier: MIT
// What a broken image lost is found with the node, the link or the transform that lost it.
#include <catch2/catch.hpp>
