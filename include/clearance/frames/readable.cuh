// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds as a device can read them. Those in host memory are copied, into buffers that stay from frame to frame.

#include <clearance/backends/device.cuh>
#include <clearance/frames/readable.hpp>

namespace clearance::frames {

/// Copies clouds from host memory, pinned memory included, into buffers that are kept from frame to frame.
class kept_copies {
 public:
  explicit kept_copies(const device& on, std::pmr::memory_resource* memory = nullptr) : on_(on), memory_(memory) {}

  /// The source itself if its memory is the device's, else a source over a copy, made in stream order.
  template <point_source S>
  S operator()(const S& source, std::uint32_t cloud) {
    if (copies_.size() <= cloud) copies_.resize(cloud + 1);
    auto& copies = copies_[cloud];
    return over_copies(source, [&](std::span<const std::byte> bytes, std::uint32_t piece) -> const std::byte* {
      if (on_.holds(bytes.data())) return bytes.data();
      if (copies.size() <= piece) copies.resize(piece + 1);
      device_buffer<std::byte>& copy = copies[piece];
      if (copy.size() < bytes.size()) copy = device_buffer<std::byte>(bytes.size(), on_.id, memory_);
      const device_guard guard(on_.id);
      check_cuda(cudaMemcpyAsync(copy.data(), bytes.data(), bytes.size(), cudaMemcpyDefault, on_.stream),
                 "cudaMemcpyAsync");
      return copy.data();
    });
  }

 private:
  device on_;
  std::pmr::memory_resource* memory_;
  std::vector<std::vector<device_buffer<std::byte>>> copies_;  ///< By cloud, then by piece.
};

template <>
class readable_clouds<device> {
 public:
  /// It is not private, because its name becomes part of a kernel's name.
  struct to_copies {
    kept_copies* copies;
    std::uint32_t cloud = 0;

    template <point_source S>
    S operator()(const S& source) {
      return (*copies)(source, cloud++);
    }
  };

  explicit readable_clouds(const device& on, std::pmr::memory_resource* memory = nullptr) : copies_(on, memory) {}

  template <class Clouds>
  auto operator()(const Clouds& clouds) {
    return mapped_clouds(clouds, to_copies{&copies_});
  }

 private:
  kept_copies copies_;
};

}  // namespace clearance::frames
