// SPDX-License-Identifier: BSD-3-Clause
#include "device_door.hpp"

#include "on_device.cuh"

#include <clearance/near_maps.hpp>

namespace {

std::shared_ptr<void> upload(const robot_trees<>& trees, int device) {
  const clearance::own_stream stream(device);
  auto made = std::visit(
      [&](const auto& model) { return std::make_shared<const robot_trees<clearance::device>>(model.on(stream.on())); },
      trees);
  stream.on().wait();
  return std::const_pointer_cast<robot_trees<clearance::device>>(made);
}

std::shared_ptr<const robot_trees<>> with_near_map(const robot_trees<>& trees, const near_map_options& options,
                                                   std::vector<std::string>& without, int device) {
  const clearance::own_stream stream(device);
  return std::visit(
      [&]<class Options>(const auto& model, const Options& its) {
        auto made = [&] {
          if constexpr (std::is_same_v<Options, clearance::field_options>)
            return clearance::with_fields(stream.on(), model, its);
          else
            return clearance::with_cells(stream.on(), model, its);
        }();
        without = std::move(made.without);
        return std::make_shared<const robot_trees<>>(std::move(made.model));
      },
      trees, options);
}

void* prepare_any(const char* type, const std::shared_ptr<void>& trees, const void* question, int device) {
  const auto found = all_makers().find(type);
  if (found == all_makers().end()) return nullptr;
  return found->second(std::static_pointer_cast<const robot_trees<clearance::device>>(trees), question, device);
}

std::shared_ptr<void> allocate(std::size_t bytes, int device) {
  const auto memory = std::make_shared<clearance::device_buffer<std::byte>>(std::max<std::size_t>(bytes, 1), device);
  return {memory, memory->data()};
}

void order(void* first, void* then, int device) {
  waiting(device).put(static_cast<cudaStream_t>(first), static_cast<cudaStream_t>(then));
}

void bring(void* to, const void* from, std::size_t bytes, int device, void* stream) {
  const clearance::device_guard guard(device);
  clearance::check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, static_cast<cudaStream_t>(stream)),
                        "cudaMemcpyAsync");
}

void wait(int device, void* stream) { clearance::device{device, static_cast<cudaStream_t>(stream)}.wait(); }

void fetch(void* to, const void* from, std::size_t bytes, int device, void* stream) {
  const clearance::device_guard guard(device);
  clearance::check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, static_cast<cudaStream_t>(stream)),
                        "cudaMemcpyAsync");
  wait(device, stream);
}

int holder(const void* memory) {
  cudaPointerAttributes attributes{};
  clearance::check_cuda(cudaPointerGetAttributes(&attributes, memory), "cudaPointerGetAttributes");
  const bool there = attributes.type == cudaMemoryTypeDevice || attributes.type == cudaMemoryTypeManaged;
  return there ? attributes.device : -1;
}

}  // namespace

const device_door& this_door() {
  static const device_door door{upload, with_near_map, prepare_any, allocate, order, bring, fetch, wait, holder};
  return door;
}

/// Empty, or why no device can be used.
std::string no_device() {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  if (error == cudaSuccess && count > 0) return {};
  cudaGetLastError();
  int driver = 0;
  if (cudaDriverGetVersion(&driver) == cudaSuccess && driver == 0) return "there is no NVIDIA driver";
  return error == cudaSuccess ? "there is no CUDA device" : cudaGetErrorString(error);
}
