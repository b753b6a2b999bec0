// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Laws of questions on a device: beside images, and frame after frame, which may be a graph.

#include "support/held_stream.cuh"
#include "support/product_device.cuh"
#include "support/question_laws.hpp"
#include "support/same_answer.hpp"

namespace testing {

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

/// In every scene a device says of points beside a depth image what the host says, in all bits.
template <class V, class P, class Cases>
void like_the_host_beside_images(const Cases& cases, const clearance::device& gpu) {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const std::tuple both(clearance::placed{all.span, s.cloud_pose}, clearance::placed{all.raw, all.camera_pose});
    for (const auto& q : cases.of_scene(s))
      v.require(same_answer(ask(gpu, there, s.poses, both, q), ask(clearance::host{}, model, s.poses, both, q)), s.name,
                ", beside an image: differs from the host's");
  }
}

/// The law of frames on a device, of few parts and of more than a kernel takes; and enqueued in a graph.
template <class Cases>
void hold_in_every_frame_on_a_device(Cases& cases, unsigned seed) {
  const own_stream stream;
  const clearance::device gpu{0, stream.handle};
  for (const std::size_t parts : {3, 130})
    hold_in_every_frame(cases, gpu, parts, seed, [&](moving_frames& f, auto& query, const auto& model, verdict& v) {
      auto to = written<Cases>(gpu, parts, 7500);
      if constexpr (!std::is_null_pointer_v<decltype(to)>) {
        const auto q = Cases::of_frame(0, parts);
        replay(
            stream, gpu, f, [&](const clouds& all) { query.enqueue(f.s.poses, all, q, to.out()); },
            [&](const std::string& what) {
              const auto expected = ask(clearance::host{}, model, f.s.poses, f.here(), q);
              to.require(expected, v, std::to_string(parts) + " parts, " + what);
              cases.saw(expected);
            });
      }
    });
}

}  // namespace testing
