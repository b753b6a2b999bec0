// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Lets loops use a processor's wide vectors, without a compiler flag and with the same bits.

#include <clearance/ground/math.hpp>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace clearance {

#if defined(__x86_64__) && defined(__GNUC__) && !(defined(__AVX2__) && defined(__FMA__))

namespace detail {

template <class F>
__attribute__((target("avx2"), flatten, noinline)) void compiled_for_wide_vectors(const F& f) {
  f();
}
template <class F>
__attribute__((target("avx2,fma"), flatten, noinline)) void compiled_for_vectors(const F& f) {
  f();
}

}  // namespace detail

/// Calls `f()`. On x86-64 it is compiled for AVX2 and fused multiply-add, and used if the processor has both: without a
/// compiler flag each fma is a call, and loops are half as wide. By the rule of math.hpp the bits are the same. A loop
/// in it that must become vector code gets a call of its own: within a large function g++ 12 leaves structs in memory.
template <class F>
void with_vectors(const F& f) {
  __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? detail::compiled_for_vectors(f) : f();
}

/// The same without fused multiply-add, for arithmetic that the rule of math.hpp does not cover: the compiler has
/// nothing to fuse with, so the bits do not depend on the processor.
template <class F>
void with_wide_vectors(const F& f) {
  __builtin_cpu_supports("avx2") ? detail::compiled_for_wide_vectors(f) : f();
}

#else

template <class F>
void with_vectors(const F& f) {
  f();
}
template <class F>
void with_wide_vectors(const F& f) {
  f();
}

#endif

/// The roots of `Count` numbers, aligned for vectors, each correctly rounded. (A loop over square_root stays scalar,
/// because a root may set errno.)
template <std::size_t Count>
inline void square_roots(const real* of, real* to) {
#if defined(__SSE2__)
  static_assert(Count % 4 == 0);
  for (std::size_t i = 0; i < Count; i += 4) _mm_store_ps(to + i, _mm_sqrt_ps(_mm_load_ps(of + i)));
#else
  for (std::size_t i = 0; i < Count; ++i) to[i] = square_root(of[i]);
#endif
}

}  // namespace clearance
