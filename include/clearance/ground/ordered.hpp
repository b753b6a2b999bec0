// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One 64-bit word that is smaller exactly if the distance is smaller, or equal with a lower index. Any number of
// threads can minimise it atomically, in any order, with one result.

#include <clearance/ground/math.hpp>

#include <atomic>
#include <bit>

namespace clearance {

CLEARANCE_HD inline std::uint32_t to_bits(real x) {
#if defined(__CUDA_ARCH__)
  return __float_as_uint(x);
#else
  return std::bit_cast<std::uint32_t>(x);
#endif
}
CLEARANCE_HD inline real from_bits(std::uint32_t u) {
#if defined(__CUDA_ARCH__)
  return __uint_as_float(u);
#else
  return std::bit_cast<real>(u);
#endif
}

/// Maps floats (never NaN) to integers in the same order; -0 and 0 map to the same.
CLEARANCE_HD inline std::uint32_t ordered(real distance) {
  const std::uint32_t u = to_bits(distance + 0.0f);
  return u & 0x80000000u ? ~u : u | 0x80000000u;
}

CLEARANCE_HD inline real from_ordered(std::uint32_t u) { return from_bits(u & 0x80000000u ? u & 0x7fffffffu : ~u); }

/// (distance, index); the least is the answer.
using distance_key = unsigned long long;

CLEARANCE_HD inline distance_key make_key(real distance, std::uint32_t index) {
  return distance_key(ordered(distance)) << 32 | index;
}
CLEARANCE_HD inline real key_distance(distance_key k) { return from_ordered(std::uint32_t(k >> 32)); }
CLEARANCE_HD inline std::uint32_t key_index(distance_key k) { return std::uint32_t(k); }

/// Infinitely far away, with no index: larger than any other key.
inline constexpr distance_key no_key = 0xff800000ffffffffull;

/// A stale value only costs work, so reads are relaxed.
template <class T>
CLEARANCE_HD T load_relaxed(const T* word) {
#if defined(__CUDA_ARCH__)
  return *reinterpret_cast<const volatile T*>(word);
#else
  return std::atomic_ref<T>(*const_cast<T*>(word)).load(std::memory_order_relaxed);
#endif
}

CLEARANCE_HD inline void lower_to(distance_key* word, distance_key value) {
#if defined(__CUDA_ARCH__)
  atomicMin(word, value);
#else
  std::atomic_ref<distance_key> shared(*word);
  for (distance_key seen = shared.load(std::memory_order_relaxed); value < seen;)
    if (shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) break;
#endif
}

CLEARANCE_HD inline void add_to(unsigned long long* word, unsigned long long value) {
#if defined(__CUDA_ARCH__)
  atomicAdd(word, value);
#else
  std::atomic_ref<unsigned long long>(*word).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Adds one. On a device, one thread of a warp adds for all that have the same word.
CLEARANCE_HD inline void add_one(unsigned long long* word) {
#if defined(__CUDA_ARCH__)
  const unsigned together = __match_any_sync(__activemask(), reinterpret_cast<unsigned long long>(word));
  if ((threadIdx.x & 31) == unsigned(__ffs(int(together)) - 1))
    add_to(word, static_cast<unsigned long long>(__popc(together)));
#else
  add_to(word, 1);
#endif
}

/// `lower_to` and `take_number` for 32-bit words.
CLEARANCE_HD inline void lower_word(std::uint32_t* word, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  atomicMin(word, value);
#else
  std::atomic_ref<std::uint32_t> shared(*word);
  for (std::uint32_t seen = shared.load(std::memory_order_relaxed); value < seen;)
    if (shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) break;
#endif
}
CLEARANCE_HD inline std::uint32_t count_one(std::uint32_t* word, std::uint32_t by = 1) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(word, by);
#else
  return std::atomic_ref<std::uint32_t>(*word).fetch_add(by, std::memory_order_relaxed);
#endif
}

/// Adds one and returns the old value.
CLEARANCE_HD inline unsigned long long take_number(unsigned long long* word) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(word, 1ull);
#else
  return std::atomic_ref<unsigned long long>(*word).fetch_add(1, std::memory_order_relaxed);
#endif
}

}  // namespace clearance
