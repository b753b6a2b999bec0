// SPDX-License-Identifier: BSD-3-Clause
// Memory, streams and launches of CUDA's runtime, on a machine without a GPU: two devices of two processors.
#include <cuda_runtime.h>

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <map>
#include <mutex>

struct emulated_stream {
  int device;
};
struct emulated_event {
  int device;
};
struct emulated_pool {
  int device;
};

namespace {

constexpr int devices = 2, processors = 2;
thread_local int current = 0;

struct piece {
  std::size_t bytes;
  cudaMemoryType type;
  int device;
};
std::mutex of_pieces;
std::map<const std::byte*, piece>& pieces() {
  static std::map<const std::byte*, piece> all;
  return all;
}

cudaError_t allocate(void** to, std::size_t bytes, cudaMemoryType type) {
  *to = nullptr;
  if (bytes == 0) return cudaSuccess;
  auto* const memory = static_cast<std::byte*>(std::aligned_alloc(256, (bytes + 255) / 256 * 256));
  if (memory == nullptr) return cudaErrorMemoryAllocation;
  std::memset(memory, 0xcd, bytes);
  const std::lock_guard lock(of_pieces);
  pieces()[memory] = {bytes, type, current};
  *to = memory;
  return cudaSuccess;
}
cudaError_t release(void* memory, cudaMemoryType type) {
  if (memory == nullptr) return cudaSuccess;
  {
    const std::lock_guard lock(of_pieces);
    const auto its = pieces().find(static_cast<std::byte*>(memory));
    if (its == pieces().end() || its->second.type != type) return cudaErrorInvalidValue;
    pieces().erase(its);
  }
  std::free(memory);
  return cudaSuccess;
}
template <class T, class... A>
cudaError_t make(T** to, A... a) {
  *to = new T{a...};
  return cudaSuccess;
}
template <class T>
cudaError_t remove(T* it) {
  delete it;
  return cudaSuccess;
}

}  // namespace

cudaError_t emulated::launch(const cudaLaunchConfig_t& how, std::function<void()> body) {
  if (how.gridDim.x == 0 || how.blockDim.x == 0 || how.blockDim.x > 1024 || how.dynamicSmemBytes > (227 << 10))
    return cudaErrorInvalidValue;
  const std::string failed = emulated::run(how.gridDim.x, how.blockDim.x, how.dynamicSmemBytes, body);
  if (failed.empty()) return cudaSuccess;
  std::fprintf(stderr, "emulated kernel: %s\n", failed.c_str());
  return cudaErrorLaunchFailure;
}

const char* cudaGetErrorString(cudaError_t code) {
  return code == cudaErrorMemoryAllocation ? "out of memory"
         : code == cudaErrorLaunchFailure  ? "an emulated kernel failed"
                                           : "an error of the emulated runtime";
}
cudaError_t cudaGetLastError() { return cudaSuccess; }
cudaError_t cudaGetDeviceCount(int* n) {
  *n = devices;
  return cudaSuccess;
}
cudaError_t cudaGetDevice(int* id) {
  *id = current;
  return cudaSuccess;
}
cudaError_t cudaSetDevice(int id) {
  if (id < 0 || id >= devices) return cudaErrorInvalidDevice;
  current = id;
  return cudaSuccess;
}
cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr what, int) {
  switch (what) {
    case cudaDevAttrMultiProcessorCount:
      *value = processors;
      break;
    case cudaDevAttrMaxSharedMemoryPerBlockOptin:
      *value = 227 << 10;
      break;
    case cudaDevAttrMaxSharedMemoryPerMultiprocessor:
      *value = 228 << 10;
      break;
    case cudaDevAttrIntegrated:
      *value = 0;
      break;
  }
  return cudaSuccess;
}
cudaError_t cudaDeviceGetLimit(std::size_t* bytes, cudaLimit) {
  *bytes = 1024;
  return cudaSuccess;
}
cudaError_t cudaDeviceSynchronize() { return cudaSuccess; }

cudaError_t cudaMalloc(void** to, std::size_t bytes) { return allocate(to, bytes, cudaMemoryTypeDevice); }
cudaError_t cudaFree(void* memory) { return release(memory, cudaMemoryTypeDevice); }
cudaError_t cudaHostAlloc(void** to, std::size_t bytes, unsigned) { return allocate(to, bytes, cudaMemoryTypeHost); }
cudaError_t cudaFreeHost(void* memory) { return release(memory, cudaMemoryTypeHost); }
cudaError_t cudaMemPoolCreate(cudaMemPool_t* pool, const cudaMemPoolProps* of) {
  static std::deque<emulated_pool> all;  // nobody gives them back
  *pool = &all.emplace_back(emulated_pool{of->location.id});
  return cudaSuccess;
}
cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t, cudaMemPoolAttr, void*) { return cudaSuccess; }
cudaError_t cudaMallocFromPoolAsync(void** to, std::size_t bytes, cudaMemPool_t, cudaStream_t) {
  return allocate(to, bytes, cudaMemoryTypeDevice);
}
cudaError_t cudaFreeAsync(void* memory, cudaStream_t) { return release(memory, cudaMemoryTypeDevice); }

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind, cudaStream_t) {
  std::memcpy(to, from, bytes);
  return cudaSuccess;
}
cudaError_t cudaMemsetAsync(void* to, int value, std::size_t bytes, cudaStream_t) {
  std::memset(to, value, bytes);
  return cudaSuccess;
}
cudaError_t cudaPointerGetAttributes(cudaPointerAttributes* of, const void* memory) {
  *of = {cudaMemoryTypeUnregistered, -1, nullptr, nullptr};
  const auto* const at = static_cast<const std::byte*>(memory);
  const std::lock_guard lock(of_pieces);
  auto its = pieces().upper_bound(at);
  if (its == pieces().begin()) return cudaSuccess;
  --its;
  if (at >= its->first + its->second.bytes) return cudaSuccess;
  void* const same = const_cast<void*>(memory);
  *of = {its->second.type, its->second.device, same, its->second.type == cudaMemoryTypeHost ? same : nullptr};
  return cudaSuccess;
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned) { return make(stream, current); }
cudaError_t cudaStreamDestroy(cudaStream_t stream) { return remove(stream); }
cudaError_t cudaStreamSynchronize(cudaStream_t) { return cudaSuccess; }
cudaError_t cudaStreamQuery(cudaStream_t) { return cudaSuccess; }
cudaError_t cudaStreamWaitEvent(cudaStream_t, cudaEvent_t, unsigned) { return cudaSuccess; }
cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) { return make(event, current); }
cudaError_t cudaEventDestroy(cudaEvent_t event) { return remove(event); }
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  return stream != nullptr && event->device != stream->device ? cudaErrorInvalidResourceHandle : cudaSuccess;
}
cudaError_t cudaEventSynchronize(cudaEvent_t) { return cudaSuccess; }
cudaError_t cudaFuncSetAttribute(const void*, cudaFuncAttribute, int) { return cudaSuccess; }
cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* of, const void*) {
  *of = {90, 90};
  return cudaSuccess;
}
