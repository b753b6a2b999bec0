// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The same frames in a device's memory, and as a graph.

#include "support/frames.hpp"
#include "support/held_stream.cuh"
#include "support/product_device.cuh"

namespace testing {

/// A frame's points in the device's memory.
struct frame_there {
  std::vector<clearance::device_buffer<vec3>> points;
  clouds all;

  frame_there(const clearance::device& gpu, const moving_frames& f) : all(f.here()) {
    for (std::size_t c = 0; c < all.size(); ++c) {
      points.push_back(gpu.copy_in(std::span<const vec3>(f.points[c])));
      all[c].source = clearance::point_span(points[c].data(), points[c].size());
    }
  }
};

/// Room for `n` values that a device writes.
template <class T>
clearance::device_buffer<T> room_on(const clearance::device& gpu, std::size_t n) {
  return gpu.copy_in(std::span<const T>(std::vector<T>(n)));
}

/// Captures what `enqueue(clouds there)` enqueues. Then it launches that again and again with other points in the same
/// memory, and calls `look(what)`.
template <class Enqueue, class Look>
void replay(const own_stream& stream, const clearance::device& gpu, moving_frames& f, const Enqueue& enqueue,
            const Look& look) {
  f.see(5000);
  const frame_there there(gpu, f);
  enqueue(there.all);  // once before: a graph cannot allocate
  gpu.wait();
  const captured_graph graph(stream.handle, [&] { enqueue(there.all); });
  for (int launch = 0; launch < 3; ++launch) {
    f.see(5000);
    for (std::size_t c = 0; c < f.points.size(); ++c)
      check(cudaMemcpyAsync(there.points[c].data(), f.points[c].data(), f.points[c].size() * sizeof(vec3),
                            cudaMemcpyDefault, stream.handle));
    graph.launch();
    gpu.wait();
    look("launch " + std::to_string(launch) + " of a graph");
  }
}

}  // namespace testing
