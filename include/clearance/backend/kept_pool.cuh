// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/cuda_error.cuh>

#include <cstdint>
#include <map>
#include <mutex>

namespace clearance {

/// A pool of device memory of the library's own, one a device, for what lives in the order of a stream. It keeps some
/// of what it once had: the driver's default pool gives all back whenever somebody waits, and takes tens of
/// microseconds to get it again. It lives as long as the process.
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
    std::uint64_t kept = 64 << 20;  // bytes; pools grow by 32 MiB, and one that has more than this gives all back
    check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &kept), "cudaMemPoolSetAttribute");
  }
  return pool;
}

}  // namespace clearance
