// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The same frames in a device's memory, and as a graph.

#include "support/frames.hpp"
#include "support/held_stream.cuh"
#include "support/product_device.cuh"

namespace testing {

/// A frame's points there.
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

/// One value that a device writes.
template <class T>
clearance::device_buffer<T> room_on(const clearance::device& gpu, std::size_t n) {
  return gpu.copy_in(std::span<const T>(std::vector<T>(n)));
}

/// Captures what `enqueue(clouds there)` enqueues, and launches that with other points in the same memory, again and
/// again: `look(what)`.
template <class Enqueue, class Look>
void replay(const own_stream& stream, const clearance::device& gpu, moving_frames& f, const Enqueue& enqueue,
            const Look& look) {
  f.see(5000);
  const frame_there there(gpu, f);
  enqueue(there.all);  // once, as memory is not for a graph
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
