// ZeroedVector: an array of values that are all zero bytes at first. They come from the system as such, page by page as
// they are touched: a vector that sets them itself holds up a large image's first pixel by some milliseconds.
#pragma once

#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace meristem {

// What it constructs without arguments is left as it is.
template <class T>
struct ZeroedAllocator {
  using value_type = T;

  ZeroedAllocator() = default;
  template <class U>
  ZeroedAllocator(const ZeroedAllocator<U>&) {}

  T* allocate(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignof(std::max_align_t));
    if (void* memory = std::calloc(count, sizeof(T))) return static_cast<T*>(memory);
    throw std::bad_alloc();
  }
  void deallocate(T* memory, std::size_t) { std::free(memory); }
  template <class U, class... Arguments>
  void construct(U* p, Arguments&&... arguments) {
    if constexpr (sizeof...(arguments) > 0) ::new (p) U(std::forward<Arguments>(arguments)...);
  }
  bool operator==(const ZeroedAllocator&) const { return true; }
};

// Grows once, by its first resize().
template <class T>
using ZeroedVector = std::vector<T, ZeroedAllocator<T>>;

}  // namespace meristem
