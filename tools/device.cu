// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/packing/pack.cuh>

#include "backends.hpp"

namespace {

// Never launched; its attributes tell whether the program has code for this GPU.
template <int>
__global__ void probe() {}

}  // namespace

clearance::packing pack_on_device(const clearance::mesh_solid& solid, const clearance::pack_options& options) {
  const clearance::own_stream stream(0);  // so that links are packed side by side
  return clearance::pack(stream.on(), solid, options);
}

device_state find_device() {
  int count = 0;
  const cudaError_t failed = cudaGetDeviceCount(&count);
  if (failed != cudaSuccess || count == 0)
    return {true, false,
            std::string("there is no CUDA device (") +
                (failed != cudaSuccess ? cudaGetErrorString(failed) : "none found") + ')'};
  cudaDeviceProp properties{};
  if (const cudaError_t why = cudaGetDeviceProperties(&properties, 0); why != cudaSuccess)
    return {true, false, std::string("the CUDA device does not answer (") + cudaGetErrorString(why) + ')'};
  const std::string name = std::string(properties.name) + " (sm_" + std::to_string(properties.major) +
                           std::to_string(properties.minor) + ')';
  cudaFuncAttributes attributes{};
  if (const cudaError_t why = cudaFuncGetAttributes(&attributes, probe<0>); why != cudaSuccess) {
    cudaGetLastError();  // clears the error, so that the next call does not see it
    return {true, false, name + " cannot run this clearance (" + cudaGetErrorString(why) + ')'};
  }
  return {true, true, name};
}
