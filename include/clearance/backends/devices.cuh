// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Several CUDA devices as one backend, and clouds that are divided among them.

#include <clearance/backends/own_stream.cuh>
#include <clearance/points/point_span.hpp>
#include <clearance/points/sharded.hpp>

#include <initializer_list>
#include <memory>
#include <vector>

namespace clearance {

/// Several CUDA devices at once: the robot is on each, and every cloud is divided among them. Each has its own stream,
/// which waits for its device's default stream, or one of the caller's. A device may be named twice. Copies of this
/// value share the streams. The caller's current device stays as it was.
class devices {
 public:
  using own_scan = void;  ///< Questions on devices need <clearance/device.cuh>.
  using several = void;   ///< A robot is on each of them.

  devices() = delete;  // nvcc 13.0 would take devices{} for devices{0}

  /// Devices by number. Throws std::invalid_argument if there is none, or if one does not exist.
  devices(std::initializer_list<int> ids) : devices(std::vector<int>(ids)) {}
  explicit devices(const std::vector<int>& ids) {
    for (const int id : ids) {
      check_exists(id);
      streams_.push_back(std::make_shared<own_stream>(id, cudaStreamDefault));
      each_.push_back(streams_.back()->on());
    }
    check_any();
  }
  /// With the caller's streams, which must outlive this. Throws std::invalid_argument also if a stream belongs to
  /// another device.
  explicit devices(std::vector<device> each) : each_(std::move(each)) {
    check_any();
    for (const device& on : each_) {
      check_exists(on.id);
      check_stream(on);
    }
  }
  /// All devices that this process sees.
  static devices all() {
    std::vector<int> ids;
    for (int id = 0; id < count(); ++id) ids.push_back(id);
    return devices(ids);
  }

  const std::vector<device>& each() const { return each_; }
  std::size_t size() const { return each_.size(); }

  void wait() const {
    for (const device& on : each_) on.wait();
  }
  /// Waits for every device, even if one of them has failed.
  void wait_for_all() const noexcept {
    for (const device& on : each_) {
      try {
        on.wait();
      } catch (...) {  // the first error is the one reported
      }
    }
  }

 private:
  static int count() {
    int there = 0;
    check_cuda(cudaGetDeviceCount(&there), "cudaGetDeviceCount");
    return there;
  }
  void check_any() const {
    if (each_.empty()) throw std::invalid_argument("clearance: devices, but not one of them");
  }
  static void check_exists(int id) {
    if (const int there = count(); id < 0 || id >= there)
      throw std::invalid_argument("clearance: there is no CUDA device " + std::to_string(id) + "; this process sees " +
                                  std::to_string(there));
  }
  /// An event cannot be recorded in another device's stream. (Asking a stream for its device needs CUDA 12.8.)
  static void check_stream(const device& on) {
    const device_guard guard(on.id);
    cudaEvent_t event = nullptr;
    check_cuda(cudaEventCreateWithFlags(&event, cudaEventDisableTiming), "cudaEventCreateWithFlags");
    const cudaError_t recorded = cudaEventRecord(event, on.stream);
    cudaEventDestroy(event);
    if (recorded == cudaErrorInvalidResourceHandle || recorded == cudaErrorInvalidValue) {
      static_cast<void>(cudaGetLastError());
      throw std::invalid_argument("clearance: the stream that was given for device " + std::to_string(on.id) +
                                  " is not one of that device");
    }
    check_cuda(recorded, "cudaEventRecord");
  }

  std::vector<std::shared_ptr<const own_stream>> streams_;
  std::vector<device> each_;
};

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
