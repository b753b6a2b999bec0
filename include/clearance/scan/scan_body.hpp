// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The loop over points for any backend without a scan of its own: every point against every part.

#include <clearance/frames/clouds.hpp>
#include <clearance/frames/frame.hpp>
#include <clearance/ground/indices.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/scan/element.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/tile_scan.hpp>
#include <clearance/scan/walk_of.hpp>

namespace clearance::scan {

/// Tests a range of points against every part, by one thread: the loop of any backend without its own scan. `Tally`
/// says how near something must be, gives a walk its visitor, and takes what it found.
template <class PartView, point_source Source, class Traversal, class Tally>
struct scan_body {
  const PartView* parts;
  const frames::placement* places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  std::uint32_t first;  ///< Number of this cloud's first point among all clouds' points.
  drop_counts* counts;
  Tally answer;
  Traversal walk;

  CLEARANCE_HD void operator()(indices range) const {
    static_assert(explain_tally<Tally>());
    drop_tally mine;
#if defined(__CUDA_ARCH__)
    for (std::size_t i = range.begin; i < range.end; i += range.step)
      if (const sample s = source[i]; mine.counts(s)) visit(s.position - origin, i);
#else
    scan_tiles(*this, range.begin, range.end, mine);
#endif
    mine.add_to(*counts);
  }

  /// A point less the origin, or its capsule.
  CLEARANCE_HD auto element(vec3 p, std::size_t i) const { return element_less(source, i, p, origin); }

  /// Tests one point against every part k whose bit k % 32 is set.
  CLEARANCE_HD void visit(vec3 p, std::size_t i, std::uint32_t near_parts = ~0u) const {
    const auto place = element(p, i);
    for (std::uint32_t k = 0; k < part_count; ++k)
      if ((near_parts >> k % 32 & 1) != 0) visit(place, first + std::uint32_t(i), k);
  }

  /// Tests a point, or its capsule, against one part. `index` is the point's number among all clouds' points.
  template <class Element>
  CLEARANCE_HD void visit(const Element& p, std::uint32_t index, std::uint32_t k) const {
    const frames::placement& place = places[k];
    if (!frames::may_reach(place.around, answer.reach_of_pair(index, k), p)) return;
    const PartView& part = parts[k];
    const auto q = moved(place.part_from_cloud, p);
    auto ask = answer.visitor(index, k);
    constexpr bool point = std::is_same_v<Element, vec3>;
    if constexpr (point)
      if (answer.foresees(index, k, q, has_interior<PartView>, ask)) return;
    if constexpr (has_interior<PartView>) {
      if (answer.settled(index, k)) return;
      if constexpr (!point)
        if (p.radius == 0 && answer.touched(index, k)) return;
      if (const vec3 start = start_of(q); part.interior.inside(start)) {
        if (answer.take_inside(index, k) && point && certainly_inside(part, start, place.error, walk))
          answer.take_certain();  // not of a capsule: what touched before is passed over, in any order
        return;
      }
    }
    walk_for(walk, part.tree, q, ask);
    answer.take(index, k, ask);
  }
};

/// Makes counts of what a loop has dropped.
struct tell_counts {
  const drop_counts* from;
  point_counts* to;
  std::uint64_t seen;

  CLEARANCE_HD void operator()(std::size_t) const { count(*to, from->dropped, seen); }
};

/// Enqueues a loop over the points of all clouds of a frame, on any backend without its own scan. `answer(source,
/// turn)` is the answer of `scan_body` for a cloud, `here(source, cloud)` a source that the backend can read. Returns
/// the facts of all clouds together.
template <class On, class PartView, class Clouds, class Answer, class Here>
frames::frame_facts plain_pass(const On& on, const model_view<PartView>& model,
                               std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer,
                               point_counts* counts, const Here& here) {
  const auto parts = std::uint32_t(model.size());
  const auto walk = walk_of(on, model);
  auto dropped = on.template make_scratch<drop_counts>(1);
  const drop_counts start;
  on.stage(std::span(&start, 1), dropped.data());

  frames::cloud_frame frame;
  const std::uint64_t seen = frames::for_each_turn(
      frame, model.facts, poses, clouds, [&]<point_source S>(const S& anywhere, const frames::turn& now) {
        const S source = here(anywhere, now.cloud);
        auto places = on.template make_scratch<frames::placement>(parts);
        on.stage(std::span<const frames::placement>(frame.places), places.data());
        const auto tally = answer(source, now);
        on.for_ranges(source.size(),
                      scan_body<PartView, S, std::remove_const_t<decltype(walk)>, std::remove_const_t<decltype(tally)>>{
                          .parts = model.parts,
                          .places = places.data(),
                          .part_count = parts,
                          .source = source,
                          .origin = frame.origin,
                          .first = now.first,
                          .counts = dropped.data(),
                          .answer = tally,
                          .walk = walk});
      });
  on.for_each(1, tell_counts{dropped.data(), counts, seen});
  return frame;
}

}  // namespace clearance::scan
