// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Memory that is not filled before it is used: megabytes kept for the worst case cost nothing while
// they are not needed, since the kernel gives a page when it is touched first.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace ada {

/// Leaves new elements as they are.
template <class T> struct UntouchedAllocator : std::allocator<T> {
  template <class U> struct rebind { using other = UntouchedAllocator<U>; };
  template <class U> void construct(U *at) noexcept { ::new (static_cast<void *>(at)) U; }
  template <class U, class... Arguments> void construct(U *at, Arguments &&...arguments) {
    ::new (static_cast<void *>(at)) U(std::forward<Arguments>(arguments)...);
  }
};

using UntouchedBytes = std::vector<std::byte, UntouchedAllocator<std::byte>>;

} // namespace ada
