// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/math.hpp>

#include <cstring>
#include <type_traits>

namespace clearance {

/// Reads memory that no thread writes while a query runs, in wide pieces. So device compilers do not take it for shared
/// memory.
template <class T>
CLEARANCE_HD T read_only(const T* from) {
#if defined(__CUDA_ARCH__)
  using word =
      std::conditional_t<alignof(T) % 16 == 0, uint4, std::conditional_t<alignof(T) % 8 == 0, uint2, std::uint32_t>>;
  if constexpr (sizeof(T) % sizeof(word) == 0 && alignof(T) >= 4) {
    union copy {
      __device__ copy() {}
      __device__ ~copy() {}
      T value;
      word words[sizeof(T) / sizeof(word)];
    } c;
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
