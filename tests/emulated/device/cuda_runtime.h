// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The language of CUDA and the part of its runtime that the library uses, for a C++ compiler and a machine without a
// GPU. Streams are in order by doing at once what they are given.

#include "emulated/block.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <tuple>
#include <type_traits>

#define __host__
#define __device__
#define __global__
#define __shared__ thread_local
#define __grid_constant__
#define __launch_bounds__(...)
#define __align__(n) __attribute__((aligned(n)))
#define __forceinline__ inline
#define __noinline__  // within __attribute__(()) it may also be empty

struct alignas(8) uint2 {
  unsigned x, y;
};
struct alignas(16) uint4 {
  unsigned x, y, z, w;
};
struct uint3 {
  unsigned x, y, z;
};
struct dim3 {
  unsigned x = 1, y = 1, z = 1;
  constexpr dim3(unsigned x = 1, unsigned y = 1, unsigned z = 1) : x(x), y(y), z(z) {}
};
inline thread_local uint3 threadIdx{0, 0, 0}, blockIdx{0, 0, 0};
inline thread_local dim3 blockDim, gridDim;

// Threads that wait for one another.

inline void __syncthreads() { emulated::meet_block(emulated::call::sync, true); }
inline int __syncthreads_and(int mine) { return int(emulated::meet_block(emulated::call::sync_and, mine != 0)); }
inline int __syncthreads_or(int mine) { return int(emulated::meet_block(emulated::call::sync_or, mine != 0)); }
inline int __syncthreads_count(int mine) { return int(emulated::meet_block(emulated::call::sync_count, mine != 0)); }
inline void __syncwarp(unsigned mask = ~0u) { emulated::meet_warp(emulated::call::warp, mask, 0); }
inline unsigned __ballot_sync(unsigned mask, int mine) {
  return unsigned(emulated::meet_warp(emulated::call::ballot, mask, mine != 0));
}
inline int __any_sync(unsigned mask, int mine) {
  return int(emulated::meet_warp(emulated::call::any, mask, mine != 0));
}
inline int __all_sync(unsigned mask, int mine) {
  return int(emulated::meet_warp(emulated::call::all, mask, mine != 0));
}
template <class T>
unsigned __match_any_sync(unsigned mask, T mine) {
  return unsigned(emulated::meet_warp(emulated::call::match, mask, std::uint64_t(mine)));
}
namespace emulated {
template <class T>
T exchanged(call what, unsigned mask, T mine, int lane) {
  static_assert(std::is_arithmetic_v<T>);
  std::uint64_t bits = 0;
  std::memcpy(&bits, &mine, sizeof mine);
  bits = meet_warp(what, mask, bits, lane);
  std::memcpy(&mine, &bits, sizeof mine);
  return mine;
}
}  // namespace emulated
template <class T>
T __shfl_sync(unsigned mask, T mine, int lane) {
  return emulated::exchanged(emulated::call::shuffle, mask, mine, lane);
}
template <class T>
T __shfl_xor_sync(unsigned mask, T mine, int lanes) {
  return emulated::exchanged(emulated::call::xored, mask, mine, lanes);
}
template <class T>
T __shfl_up_sync(unsigned mask, T mine, unsigned by) {
  return emulated::exchanged(emulated::call::up, mask, mine, int(by));
}
template <class T>
T __shfl_down_sync(unsigned mask, T mine, unsigned by) {
  return emulated::exchanged(emulated::call::down, mask, mine, int(by));
}
inline unsigned __reduce_add_sync(unsigned mask, unsigned mine) {
  return unsigned(emulated::meet_warp(emulated::call::sum, mask, mine));
}
inline unsigned __reduce_min_sync(unsigned mask, unsigned mine) {
  return unsigned(emulated::meet_warp(emulated::call::least, mask, mine));
}
inline unsigned __reduce_max_sync(unsigned mask, unsigned mine) {
  return unsigned(emulated::meet_warp(emulated::call::most, mask, mine));
}
[[gnu::noinline]] inline unsigned __activemask() { return emulated::lanes_here(__builtin_return_address(0)); }

inline void __threadfence() { emulated::between(); }
inline void __threadfence_block() { emulated::between(); }
inline void __threadfence_system() { emulated::between(); }
inline void __nanosleep(unsigned) { emulated::wait_for_others(); }
inline long long clock64() {
  static long long clock = 0;
  emulated::wait_for_others();
  return __atomic_add_fetch(&clock, 1000, __ATOMIC_RELAXED);
}
[[noreturn]] inline void __trap() { emulated::fail("__trap"); }

// Atomics. The old value comes back.

namespace emulated {
template <class T, class F>
T changed(T* word, F f) {
  between();
  T old = __atomic_load_n(word, __ATOMIC_RELAXED);
  while (!__atomic_compare_exchange_n(word, &old, T(f(old)), true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
  between();
  return old;
}
}  // namespace emulated
template <class T>
T atomicAdd(T* word, std::type_identity_t<T> by) {
  return emulated::changed(word, [by](T old) { return old + by; });
}
template <class T>
T atomicSub(T* word, std::type_identity_t<T> by) {
  return emulated::changed(word, [by](T old) { return old - by; });
}
template <class T>
T atomicMin(T* word, std::type_identity_t<T> value) {
  return emulated::changed(word, [value](T old) { return value < old ? value : old; });
}
template <class T>
T atomicMax(T* word, std::type_identity_t<T> value) {
  return emulated::changed(word, [value](T old) { return old < value ? value : old; });
}
template <class T>
T atomicAnd(T* word, std::type_identity_t<T> value) {
  return emulated::changed(word, [value](T old) { return old & value; });
}
template <class T>
T atomicOr(T* word, std::type_identity_t<T> value) {
  return emulated::changed(word, [value](T old) { return old | value; });
}
template <class T>
T atomicExch(T* word, std::type_identity_t<T> value) {
  return emulated::changed(word, [value](T) { return value; });
}
/// Who finds another value than it expects may be about to wait for it.
template <class T>
T atomicCAS(T* word, std::type_identity_t<T> expected, std::type_identity_t<T> value) {
  const T old = emulated::changed(word, [=](T now) { return now == expected ? value : now; });
  if (old != expected) emulated::wait_for_others();
  return old;
}

// Arithmetic and bits.

inline float __fmaf_rn(float a, float b, float c) { return std::fma(a, b, c); }
inline double __fma_rn(double a, double b, double c) { return std::fma(a, b, c); }
inline float __fmul_rn(float a, float b) {
  const volatile float product = a * b;
  return product;
}
inline float __fsqrt_rn(float a) { return std::sqrt(a); }
inline float __fdiv_rn(float a, float b) { return a / b; }
inline float __saturatef(float a) { return a > 0 ? (a < 1 ? a : 1) : 0; }
inline unsigned __float_as_uint(float a) { return std::bit_cast<unsigned>(a); }
inline float __uint_as_float(unsigned a) { return std::bit_cast<float>(a); }
inline int __popc(unsigned a) { return __builtin_popcount(a); }
inline int __ffs(int a) { return __builtin_ffs(a); }
inline int __ffsll(long long a) { return __builtin_ffsll(a); }
inline int __clz(int a) { return a == 0 ? 32 : __builtin_clz(unsigned(a)); }
inline unsigned __umulhi(unsigned a, unsigned b) { return unsigned(std::uint64_t(a) * b >> 32); }
inline unsigned __funnelshift_lc(unsigned low, unsigned high, unsigned by) {
  by = by < 32 ? by : 32;
  return unsigned((std::uint64_t(high) << 32 | low) << by >> 32);
}
inline unsigned __vcmpeq4(unsigned a, unsigned b) {
  unsigned same = 0;
  for (int k = 0; k < 32; k += 8)
    if ((a >> k & 0xff) == (b >> k & 0xff)) same |= 0xffu << k;
  return same;
}
inline unsigned __vcmpne4(unsigned a, unsigned b) { return ~__vcmpeq4(a, b); }
template <class T>
T __ldg(const T* from) {
  return *from;
}

// The runtime.

enum cudaError_t {
  cudaSuccess = 0,
  cudaErrorInvalidValue = 1,
  cudaErrorMemoryAllocation = 2,
  cudaErrorInvalidDevice = 101,
  cudaErrorInvalidResourceHandle = 400,
  cudaErrorNotReady = 600,
  cudaErrorLaunchFailure = 719,
};
enum cudaDeviceAttr {
  cudaDevAttrMultiProcessorCount,
  cudaDevAttrMaxSharedMemoryPerBlockOptin,
  cudaDevAttrMaxSharedMemoryPerMultiprocessor,
  cudaDevAttrIntegrated,
};
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost, cudaMemcpyDeviceToDevice, cudaMemcpyDefault };
enum cudaMemoryType { cudaMemoryTypeUnregistered, cudaMemoryTypeHost, cudaMemoryTypeDevice, cudaMemoryTypeManaged };
enum cudaLimit { cudaLimitStackSize };
enum cudaFuncAttribute { cudaFuncAttributeMaxDynamicSharedMemorySize };
enum cudaLaunchAttributeID { cudaLaunchAttributeProgrammaticStreamSerialization };
enum cudaMemPoolAttr { cudaMemPoolAttrReleaseThreshold };
enum cudaMemAllocationType { cudaMemAllocationTypePinned };
enum cudaMemLocationType { cudaMemLocationTypeDevice };
inline constexpr unsigned cudaStreamDefault = 0, cudaStreamNonBlocking = 1, cudaEventDisableTiming = 2,
                          cudaHostAllocPortable = 1, cudaHostAllocMapped = 2;

using cudaStream_t = struct emulated_stream*;
using cudaEvent_t = struct emulated_event*;
using cudaMemPool_t = struct emulated_pool*;
struct cudaPointerAttributes {
  cudaMemoryType type;
  int device;
  void *devicePointer, *hostPointer;
};
struct cudaFuncAttributes {
  int ptxVersion, binaryVersion;
};
struct cudaMemPoolProps {
  cudaMemAllocationType allocType;
  struct {
    cudaMemLocationType type;
    int id;
  } location;
};
struct cudaLaunchAttribute {
  cudaLaunchAttributeID id;
  struct {
    int programmaticStreamSerializationAllowed;
  } val;
};
struct cudaLaunchConfig_t {
  dim3 gridDim, blockDim;
  std::size_t dynamicSmemBytes;
  cudaStream_t stream;
  cudaLaunchAttribute* attrs;
  unsigned numAttrs;
};

const char* cudaGetErrorString(cudaError_t);
cudaError_t cudaGetLastError();
cudaError_t cudaGetDeviceCount(int*);
cudaError_t cudaGetDevice(int*);
cudaError_t cudaSetDevice(int);
cudaError_t cudaDeviceGetAttribute(int*, cudaDeviceAttr, int);
cudaError_t cudaDeviceGetLimit(std::size_t*, cudaLimit);
cudaError_t cudaDeviceSynchronize();
cudaError_t cudaMalloc(void**, std::size_t);
cudaError_t cudaFree(void*);
cudaError_t cudaHostAlloc(void**, std::size_t, unsigned);
cudaError_t cudaFreeHost(void*);
cudaError_t cudaMemPoolCreate(cudaMemPool_t*, const cudaMemPoolProps*);
cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t, cudaMemPoolAttr, void*);
cudaError_t cudaMallocFromPoolAsync(void**, std::size_t, cudaMemPool_t, cudaStream_t);
cudaError_t cudaFreeAsync(void*, cudaStream_t);
cudaError_t cudaMemcpyAsync(void*, const void*, std::size_t, cudaMemcpyKind, cudaStream_t);
cudaError_t cudaMemsetAsync(void*, int, std::size_t, cudaStream_t);
cudaError_t cudaPointerGetAttributes(cudaPointerAttributes*, const void*);
cudaError_t cudaStreamCreateWithFlags(cudaStream_t*, unsigned);
cudaError_t cudaStreamDestroy(cudaStream_t);
cudaError_t cudaStreamSynchronize(cudaStream_t);
cudaError_t cudaStreamQuery(cudaStream_t);
cudaError_t cudaStreamWaitEvent(cudaStream_t, cudaEvent_t, unsigned = 0);
cudaError_t cudaEventCreateWithFlags(cudaEvent_t*, unsigned);
cudaError_t cudaEventDestroy(cudaEvent_t);
cudaError_t cudaEventRecord(cudaEvent_t, cudaStream_t);
cudaError_t cudaEventSynchronize(cudaEvent_t);
cudaError_t cudaFuncSetAttribute(const void*, cudaFuncAttribute, int);
cudaError_t cudaFuncGetAttributes(cudaFuncAttributes*, const void*);

namespace emulated {
/// Enqueues a kernel, whose threads call `body`.
cudaError_t launch(const cudaLaunchConfig_t&, std::function<void()> body);
}  // namespace emulated

template <class... P, class... A>
cudaError_t cudaLaunchKernelEx(const cudaLaunchConfig_t* how, void (*kernel)(P...), A&&... arguments) {
  const std::tuple<std::remove_cv_t<P>...> copies(static_cast<A&&>(arguments)...);
  return emulated::launch(*how, [kernel, copies] { std::apply(kernel, copies); });
}
