// SPDX-License-Identifier: MIT
#include "scenes/error.h"

#include <cstdio>
#include <cstdlib>

namespace plumbline {

void invariant_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "plumbline: internal error at %s:%d: %s does not hold. This is a bug in Plumbline.\n", file,
               line, condition);
  std::abort();
}

}  // namespace plumbline
