// SPDX-License-Identifier: MIT
// Two halves of a loop at once: for the copying between rays, textures and hits, which would else keep one core busy
// and the others waiting.
#pragma once

#include <cstddef>
#include <thread>

namespace plumbline {

/// Calls work(half, first, end) for both halves of [0, count), half 0 on a thread of its own where it is worth one.
/// Returns when both are done.
template <typename Work>
void in_halves(std::size_t count, const Work& work) {
  constexpr std::size_t kWorthAThread = 1 << 14;
  const std::size_t middle = count / 2;
  if (count < kWorthAThread) {
    work(0, std::size_t{0}, middle);
    work(1, middle, count);
    return;
  }
  std::thread other([&] { work(0, std::size_t{0}, middle); });
  work(1, middle, count);
  other.join();
}

}  // namespace plumbline
