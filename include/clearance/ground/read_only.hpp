// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads memory that nobody writes meanwhile, in the widest words that it allows.

#include <clearance/ground/math.hpp>

#include <cstring>
#include <type_traits>

namespace clearance {

/// A value and the words that it is made of, for kernels that move it in words.
template <class T, class Word>
union as_words {
  CLEARANCE_HD as_words() {}
  CLEARANCE_HD ~as_words() {}
  T value;
  Word words[sizeof(T) / sizeof(Word)];
};

/// Reads memory that no thread writes while a query runs, in wide pieces. So device compilers do not take it for shared
/// memory.
template <class T>
CLEARANCE_HD T read_only(const T* from) {
#if defined(__CUDA_ARCH__)
  using word =
      std::conditional_t<alignof(T) % 16 == 0, uint4, std::conditional_t<alignof(T) % 8 == 0, uint2, std::uint32_t>>;
  if constexpr (sizeof(T) % sizeof(word) == 0 && alignof(T) >= 4) {
    as_words<T, word> c;
#pragma unroll
    for (std::size_t i = 0; i < sizeof(T) / sizeof(word); ++i)
      c.words[i] = __ldg(reinterpret_cast<const word*>(from) + i);
    return c.value;
  }
  return *from;
#else
  T value;  // what lies there may be of another type, such as four points of three floats
  std::memcpy(&value, from, sizeof value);
  return value;
#endif
}

}  // namespace clearance
