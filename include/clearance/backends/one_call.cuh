// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Device memory for a question that is asked once: in stream order, with few requests to the driver.

#include <clearance/backends/device.cuh>
#include <clearance/backends/device_buffer.cuh>
#include <clearance/backends/one_call.hpp>

#include <algorithm>
#include <vector>

namespace clearance {

/// Device memory for one call, in stream order. It is allocated in large blocks, handed out in pieces and given back as
/// a whole, because each request to the driver takes microseconds.
class stream_resource : public std::pmr::memory_resource {
 public:
  stream_resource(int device, cudaStream_t stream) : device_(device), stream_(stream) {}

 private:
  static constexpr std::size_t least = 256 << 10;  ///< A robot of eight links needs 100 KiB.

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    const std::size_t at = (used_ + alignment - 1) / alignment * alignment;
    if (blocks_.empty() || at + bytes > blocks_.back().size()) {
      blocks_.emplace_back(std::max(bytes, least), device_, stream_);  // aligned for anything
      used_ = bytes;
      return blocks_.back().data();
    }
    used_ = at + bytes;
    return blocks_.back().data() + at;
  }
  void do_deallocate(void*, std::size_t, std::size_t) override {}
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  int device_;
  cudaStream_t stream_;
  std::size_t used_ = 0;  ///< Bytes used of the last block.
  std::vector<stream_buffer<std::byte>> blocks_;
};

}  // namespace clearance

namespace clearance::detail {

/// Memory for one call comes in stream order.
template <>
struct one_call<device> {
  template <class Ask>
  static auto of(const device& on, const Ask& ask) {
    stream_resource memory(on.id, on.stream);
    return ask(&memory);
  }
};

}  // namespace clearance::detail
