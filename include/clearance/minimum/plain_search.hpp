// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The least distance by the paper's loop over points, on any backend and with any traversal.

#include <clearance/frames/readable.hpp>
#include <clearance/minimum/resolve.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/scan/descend.hpp>
#include <clearance/scan/scan_body.hpp>

namespace clearance::minimum {

/// Lowers the bound by the distance of one real pair. `p` is a point less the frame's origin.
template <class Body>
CLEARANCE_HD void seed(const Body& body, vec3 p, std::uint32_t index, std::uint32_t k) {
  const auto& tree = body.parts[k].tree;
  const real d =
      scan::descend(scan::plain_steps<std::remove_cvref_t<decltype(tree)>>{tree}, body.places[k].part_from_cloud(p));
  if (d < infinity) body.answer.lower(index, k, d);
}

/// Before all others, a few points spread over the cloud each go greedily down to one leaf. Any real pair is a valid
/// bound, and a good bound saves most of the work. Without it, thousands of threads would start from infinity at once.
template <class Body>
struct seed_body {
  static constexpr std::size_t samples = 2048;

  Body body;
  std::size_t stride;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const sample s = body.source[i * stride];
    if (!s.valid()) return;
    const vec3 p = s.position - body.origin;
    const auto index = body.first + std::uint32_t(i * stride);
    std::uint32_t nearest_part = 0;
    real least = infinity;
    for (std::uint32_t k = 0; k < body.part_count; ++k) {
      if (body.answer.bound_per_part()) seed(body, p, index, k);  // every part wants a bound of its own
      const ball& around = body.places[k].around;
      const real lb = length(p - around.center) - around.radius;
      if (lb < least) {
        least = lb;
        nearest_part = k;
      }
    }
    if (!body.answer.bound_per_part()) seed(body, p, index, nearest_part);
  }
};

/// The least distance by a loop over points with any traversal, on any backend. It keeps nothing from frame to frame.
template <backend B, class PartView>
class plain_search {
 public:
  plain_search(const B& on, const model_view<PartView>& model) : on_(on), model_(model) {}

  /// Enqueues one frame and does not wait. `result` and `minima` (one per part, or null) lie in memory that the backend
  /// can write, and are valid once its work is done. Clouds must live until then, and be readable there.
  template <class Clouds>
  void operator()(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, min_distance_result* result,
                  part_minimum* minima) const {
    const auto walk = scan::walk_of(on_, model_);
    using walk_type = std::remove_const_t<decltype(walk)>;
    const auto parts = std::uint32_t(model_.size());
    auto all = on_.template make_scratch<totals>(1);
    auto counts = on_.template make_scratch<scan::drop_counts>(1);
    std::vector<real> extra;
    if (minima == nullptr) frames::extra_reaches(model_.facts, extra);
    auto extras = on_.template make_scratch<real>(extra.size());
    if (!extra.empty()) on_.stage(std::span<const real>(extra), extras.data());
    const bool each = minima != nullptr || !extra.empty();
    auto part_best = on_.template make_scratch<distance_key>(each ? parts : 0);
    fill(all.data(), totals{}, 1);
    fill(counts.data(), scan::drop_counts{}, 1);
    fill(result, min_distance_result{}, 1);
    if (each) fill(part_best.data(), no_key, parts);
    if (minima != nullptr) fill(minima, part_minimum{}, parts);
    const shared_bounds bounds{all.data(), each ? part_best.data() : nullptr, extra.empty() ? nullptr : extras.data()};
    frames::cloud_frame frame;
    const std::uint64_t seen = frames::for_each_turn(
        frame, model_.facts, poses, clouds, [&]<point_source S>(const S& source, const frames::turn& now) {
          auto places = on_.template make_scratch<frames::placement>(parts);
          on_.stage(std::span<const frames::placement>(frame.places), places.data());
          using loop = scan::scan_body<PartView, S, walk_type, shared_bounds>;
          const loop body{model_.parts, places.data(), parts,  source, frame.origin,
                          now.first,    counts.data(), bounds, walk};
          using seeds = seed_body<loop>;
          if (const std::size_t n = source.size(); n > 4 * seeds::samples)
            on_.for_each(seeds::samples, seeds{body, n / seeds::samples});
          on_.for_ranges(source.size(), body);
          on_.for_each(parts + 1, resolve_body<PartView, S, walk_type>{model_.parts, places.data(), parts, source,
                                                                       frame.origin, frame.world_from_cloud, now.first,
                                                                       now.cloud, bounds, walk, result, minima});
        });
    on_.for_each(
        1, conclude_body<PartView>{model_.parts, parts, counts.data(), bounds, frame.error, frame.slop, seen, result});
  }

 private:
  template <class T>
  void fill(T* to, const T& value, std::size_t n) const {
    on_.stage(std::span<const T>(std::vector<T>(n, value)), to);
  }

  B on_;
  model_view<PartView> model_;
};

}  // namespace clearance::minimum
