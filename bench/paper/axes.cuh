// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The design space on a GPU that holds the points: each axis alone, from the paper's own method (recursive, one stream
// per part, bound shared by all, unseeded) and from its best variant (near first, fused).

#include "lab.cuh"
#include "moved.cuh"
#include "sequential.hpp"

namespace bench::paper {

using clearance::near_first;
using clearance::recursive;

/// Fig. 4 left: how a tree is walked.
template <class Parts>
void traversals(lab& l, const Parts& parts, double reference) {
  l.out.begin("traversal", l.scene->name, l.points.size());
  l.time_method("recursive", method<shared_by_all, recursive>{}, parts, reference);
  l.time_method("stack", method<shared_by_all, clearance::stack>{}, parts, reference);
  l.time_method("near first", method<shared_by_all, near_first>{}, parts, reference);
  l.time_method("cooperative", method<shared_by_all, cooperative>{}, parts, reference);
}

/// Fig. 4 right: parts in sequence, in streams, or in one kernel: in a thread's loop ("fused"), or as a grid of parts x
/// points.
template <class Parts>
void schedules(lab& l, const Parts& parts, double reference) {
  l.out.begin("schedule", l.scene->name, l.points.size());
  for (const auto& [name, order] : {std::pair{"sequential", schedule::sequential},
                                    {"streams", schedule::streams},
                                    {"fused", schedule::fused},
                                    {"grid", schedule::grid}}) {
    l.time_method(std::string("recursive; ") + name, paper_method{.order = order}, parts, reference);
    l.time_method(std::string("near first; ") + name, method<shared_by_all, near_first>{.order = order}, parts,
                  reference);
  }
}

/// Section 4.2: what is moved. Moved trees round differently, so these agree only to 2 um.
template <class Model, class Parts>
void transforms(lab& l, const Model& model, const Parts& parts, double reference) {
  l.out.begin("transform", l.scene->name, l.points.size());
  l.time_method("points into parts", paper_method{}, parts, reference);
  l.time_method("survivors into parts", method<shared_by_all, recursive, survivors_into_parts>{}, parts, reference);
  const moved_trees trees(model, l.gpu.id);
  const method<shared_by_all, recursive, trees_beforehand> beforehand;
  const method<shared_by_all, recursive, volumes_in_walk> in_walk;
  l.time(
      "trees beforehand", [&] { beforehand.enqueue(l.streams, trees.enqueue(parts), l.cloud(), l.bound(), nullptr); },
      reference, 2e-6);
  l.time(
      "volumes in the walk", [&] { in_walk.enqueue(l.streams, parts, l.cloud(), l.bound(), nullptr); }, reference,
      2e-6);
}

/// Fig. 7 left: who shares the bound; times here, counts in `culling`.
template <class Parts>
void sharing(lab& l, const Parts& parts, double reference) {
  l.out.begin("sharing", l.scene->name, l.points.size());
  l.time_method("recursive; nobody", method<shared_by_nobody, recursive>{}, parts, reference);
  l.time_method("recursive; block", method<shared_by_block, recursive>{}, parts, reference);
  l.time_method("recursive; all", method<shared_by_all, recursive>{}, parts, reference);
  l.time_method("near first; nobody", method<shared_by_nobody, near_first>{}, parts, reference);
  l.time_method("near first; block", method<shared_by_block, near_first>{}, parts, reference);
  l.time_method("near first; all", method<shared_by_all, near_first>{}, parts, reference);
  // As many threads as the paper's GTX 780 holds (12 multiprocessors of 2,048): 3 blocks per part. They stay and take
  // one point after another, with the block's bound.
  l.time_method("recursive; block; few threads", method<shared_by_block, recursive>{.threads = 1024, .most_blocks = 3},
                parts, reference);
  l.time_method("recursive; all; few threads", method<shared_by_all, recursive>{.threads = 1024, .most_blocks = 3},
                parts, reference);
}

template <class Walk>
void cache_of(lab& l, const std::string& walk, const auto& parts, double reference) {
  using m = method<shared_by_all, Walk>;
  using view = std::remove_cvref_t<decltype(parts.part[0].tree)>;
  const auto kernel = m::template kernel<view, clearance::point_span>();
  for (const auto& [name, preference] : {std::pair{"no preference", cudaFuncCachePreferNone},
                                         {"prefer shared", cudaFuncCachePreferShared},
                                         {"prefer L1", cudaFuncCachePreferL1}}) {
    check_cuda(cudaFuncSetCacheConfig(kernel, preference), "cudaFuncSetCacheConfig");
    l.time_method(walk + "; " + name, m{}, parts, reference);
  }
  check_cuda(cudaFuncSetCacheConfig(kernel, cudaFuncCachePreferNone), "cudaFuncSetCacheConfig");
  for (const int percent : {0, 50, 100}) {
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributePreferredSharedMemoryCarveout, percent),
               "cudaFuncSetAttribute");
    l.time_method(walk + "; carveout " + std::to_string(percent) + " %", m{}, parts, reference);
  }
  check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributePreferredSharedMemoryCarveout, cudaSharedmemCarveoutDefault),
             "cudaFuncSetAttribute");
}

/// Fig. 7 right: more cache and less shared memory, and the reverse.
template <class Parts>
void caches(lab& l, const Parts& parts, double reference) {
  l.out.begin("cache", l.scene->name, l.points.size());
  cache_of<recursive>(l, "recursive", parts, reference);
  cache_of<near_first>(l, "near first", parts, reference);
}

template <class Method, class Parts>
void blocks_of(lab& l, const std::string& walk, const Parts& parts, double reference) {
  using view = std::remove_cvref_t<decltype(parts.part[0].tree)>;
  cudaFuncAttributes facts{};
  check_cuda(cudaFuncGetAttributes(&facts, Method::template kernel<view, clearance::point_span>()),
             "cudaFuncGetAttributes");
  for (unsigned threads = 32; threads <= unsigned(facts.maxThreadsPerBlock); threads *= 2) {
    l.out.begin("block size", l.scene->name, l.points.size(), threads);
    l.time_method(walk, Method{.threads = threads}, parts, reference);
  }
}

template <class Parts>
void block_sizes(lab& l, const Parts& parts, double reference) {
  blocks_of<paper_method>(l, "recursive; all", parts, reference);
  blocks_of<method<shared_by_block, recursive>>(l, "recursive; block", parts, reference);
  blocks_of<method<shared_by_all, near_first>>(l, "near first; all", parts, reference);
}

/// Where the bound starts: at infinity, from a sample spread over the cloud, or just above the last frame's answer.
template <class Method, class Parts>
void seeds_of(lab& l, const std::string& name, const Method& m, const Parts& parts, double reference) {
  l.time_method(name + "; none", m, parts, reference);
  const std::size_t stride = std::max<std::size_t>(1, l.points.size() / 2048);
  l.time(
      name + "; sample",
      [&] {
        m.launch(parts, 0, parts.count, l.cloud(), l.bound(), nullptr, nullptr, stride);
        m.enqueue(l.streams, parts, l.cloud(), l.bound(), nullptr);
      },
      reference);
  l.time(
      name + "; last witness", [&] { m.enqueue(l.streams, parts, l.cloud(), l.bound(), nullptr); }, reference, 0,
      real(reference * 1.0001));
}

template <class Parts>
void seeds(lab& l, const Parts& parts, double reference) {
  l.out.begin("seed", l.scene->name, l.points.size());
  seeds_of(l, "recursive streams", paper_method{}, parts, reference);
  seeds_of(l, "near first fused", method<shared_by_all, near_first>{.order = schedule::fused}, parts, reference);
  seeds_of(l, "near first fused survivors",
           method<shared_by_all, near_first, survivors_into_parts>{.order = schedule::fused}, parts, reference);
}

/// Is it due to culling? Node tests, leaf tests and accepted updates per point, by who shares the bound.
template <class Model, class Parts>
void culling(lab& l, const Model& on_host, const Parts& parts, double reference) {
  l.out.begin("culling", l.scene->name, l.points.size());
  const clearance::frames::cloud_frame frame(on_host.view().facts, l.poses, l.scene->world_from_cloud);
  counts one{}, near{};
  l.out.expect("recursive; sequential",
               sequential<recursive, true>(on_host.view(), frame, clearance::point_span(l.points), {}, &one),
               reference);
  l.write("recursive; sequential", one);
  l.out.expect("near first; sequential",
               sequential<near_first, true>(on_host.view(), frame, clearance::point_span(l.points), {}, &near),
               reference);
  l.write("near first; sequential", near);
  l.count("recursive; nobody", method<shared_by_nobody, recursive, points_into_parts, true>{}, parts, reference);
  l.count("recursive; block", method<shared_by_block, recursive, points_into_parts, true>{}, parts, reference);
  l.count("recursive; all", method<shared_by_all, recursive, points_into_parts, true>{}, parts, reference);
  l.count("recursive; all; sequential parts",
          method<shared_by_all, recursive, points_into_parts, true>{.order = schedule::sequential}, parts, reference);
  l.count("recursive; all; fused parts",
          method<shared_by_all, recursive, points_into_parts, true>{.order = schedule::fused}, parts, reference);
  l.count("recursive; all; grid of parts",
          method<shared_by_all, recursive, points_into_parts, true>{.order = schedule::grid}, parts, reference);
  l.count("near first; nobody", method<shared_by_nobody, near_first, points_into_parts, true>{}, parts, reference);
  l.count("near first; block", method<shared_by_block, near_first, points_into_parts, true>{}, parts, reference);
  l.count("recursive; block; few threads",
          method<shared_by_block, recursive, points_into_parts, true>{.threads = 1024, .most_blocks = 3}, parts,
          reference);
  l.count("recursive; all; few threads",
          method<shared_by_all, recursive, points_into_parts, true>{.threads = 1024, .most_blocks = 3}, parts,
          reference);
  const method<shared_by_all, near_first, points_into_parts, true> best;
  l.count("near first; all", best, parts, reference);
  l.count("near first; all; last witness", best, parts, reference, real(reference * 1.0001));
}

}  // namespace bench::paper
