// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/cuda_error.cuh>

#include <cstdint>
#include <map>
#include <mutex>

namespace clearance {

/// The library's own pool of device memory, one per device, for memory in stream order. It keeps some memory: the
/// driver's default pool releases everything whenever someone waits, and takes tens of microseconds to get it again. It
/// is never destroyed.
inline cudaMemPool_t kept_pool(int device) {
  static std::mutex one_at_a_time;
  static std::map<int, cudaMemPool_t> pools;
  const std::lock_guard lock(one_at_a_time);
  cudaMemPool_t& pool = pools[device];
  if (pool == nullptr) {
    cudaMemPoolProps properties{};
    properties.allocType = cudaMemAllocationTypePinned;
    properties.location.type = cudaMemLocationTypeDevice, properties.location.id = device;
    check_cuda(cudaMemPoolCreate(&pool, &properties), "cudaMemPoolCreate");
    std::uint64_t kept = 64 << 20;  // bytes; pools grow by 32 MiB, and one that has more than this releases everything
    check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &kept), "cudaMemPoolSetAttribute");
  }
  return pool;
}

}  // namespace clearance
