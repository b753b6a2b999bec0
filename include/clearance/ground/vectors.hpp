// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/ground/config.hpp>

namespace clearance {

#if defined(__x86_64__) && defined(__GNUC__) && !(defined(__AVX2__) && defined(__FMA__))

namespace detail {

template <class F>
__attribute__((target("avx2,fma"), flatten)) void compiled_for_vectors(const F& f) {
  f();
}

}  // namespace detail

/// Calls `f()`: on x86-64 with AVX2 and fused multiply-add, if the processor turns out to have both. Without a compiler
/// flag each fma is a call, and loops are half as wide. Same bits either way, for what keeps to the rule of math.hpp.
template <class F>
void with_vectors(const F& f) {
  __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? detail::compiled_for_vectors(f) : f();
}

#else

template <class F>
void with_vectors(const F& f) {
  f();
}

#endif

}  // namespace clearance
