// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/devices.cuh>
#include <clearance/points/point_span.hpp>
#include <clearance/points/sharded.hpp>

namespace clearance {

/// Owns a cloud in pieces, each in the memory of one of several devices. `Piece` is a slice of the original source.
template <point_source Piece>
class shards {
 public:
  /// Copies slices of about equal length, to all devices at once, and waits.
  template <point_source S>
  shards(const devices& on, const S& cloud) : view_(copied(on, cloud)) {}

  /// Pass this to a call as the cloud.
  const sharded<Piece>& view() const { return view_; }

 private:
  template <point_source S>
  std::vector<Piece> copied(const devices& on, const S& cloud) {
    std::vector<Piece> there;
    for (std::size_t k = 0; k < on.size(); ++k) {
      const device& its = on.each()[k];
      const Piece piece = piece_of(cloud, k, on.size());
      const std::span<const std::byte> bytes = piece.bytes();
      const device_guard guard(its.id);
      memory_.emplace_back(bytes.size(), its.id);
      if (!bytes.empty())
        check_cuda(cudaMemcpyAsync(memory_.back().data(), bytes.data(), bytes.size(), cudaMemcpyDefault, its.stream),
                   "cudaMemcpyAsync");
      there.push_back(piece.at(memory_.back().data()));
    }
    on.wait();
    return there;
  }

  std::vector<device_buffer<std::byte>> memory_;
  sharded<Piece> view_;
};

/// Copies a cloud's slices, one to each device, for clouds that stay or are too large for one device. The points may be
/// in host memory or on any device.
template <point_source S>
auto shard(const devices& on, const S& cloud) {
  static_assert(
      requires { cloud.at(cloud.bytes().data()); },
      "a source that does not say where its bytes are cannot be copied to devices");
  return shards<decltype(piece_of(cloud, 0, 1))>(on, cloud);
}
inline auto shard(const devices& on, const std::vector<vec3>& points) { return shard(on, point_span(points)); }

}  // namespace clearance
