// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Work on blocks by several threads, with results that do not depend on how many: the blocks are
// fixed by the data, and what comes of them is put together in their order.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace ada {

/// Threads that one call may use; 0, and from the start: as many as the process may run on.
void set_jobs(unsigned jobs) noexcept;
unsigned jobs() noexcept;

/// Threads that are kept for all loops within a scope, of this thread and of those that help it: to
/// start them anew for each of the thousands of short loops of a diagnosis took a third of its
/// time. A scope within another uses its threads; set_jobs counts from the next scope on. Threads
/// belong to a scope and not to the process: after a fork, or once the library is unloaded, none is
/// missed.
class Helpers {
public:
  Helpers();
  ~Helpers();
  Helpers(const Helpers &) = delete;
  Helpers &operator=(const Helpers &) = delete;

  class Crew;

private:
  std::unique_ptr<Crew> own_; ///< none within another scope
};

namespace detail {
void run_in_order(std::size_t count, std::size_t window,
                  const std::function<void(std::size_t)> &make,
                  const std::function<void(std::size_t)> &take);
}

/// For each block of `count`: make(block, slot), in any thread, then take(block, slot), in the
/// calling one and block after block. A slot is used again for a later block, with what it then
/// holds, so that its memory need not be got anew; there are two a thread. Where calls throw, the
/// exception of the earliest block comes out once no thread works on them.
template <class Slot, class Make, class Take>
void in_order(std::size_t count, Make make, Take take) {
  std::vector<Slot> slots(jobs() > 1 ? 2 * jobs() : 1);
  detail::run_in_order(
      count, slots.size(), [&](std::size_t k) { make(k, slots[k % slots.size()]); },
      [&](std::size_t k) { take(k, slots[k % slots.size()]); });
}

/// The same without a second step.
template <class Slot, class Make> void for_each_block(std::size_t count, Make make) {
  in_order<Slot>(count, make, [](std::size_t, Slot &) {});
}

} // namespace ada
