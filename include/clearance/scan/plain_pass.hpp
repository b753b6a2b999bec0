// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/frame/clouds.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/scan/scan_body.hpp>
#include <clearance/traversal/any_depth.hpp>

namespace clearance::scan {

/// Enqueues a loop over the points of all clouds of a frame, on any backend without its own scan. `answer(source,
/// turn)` is the answer of `scan_body` for a cloud, `here(source, cloud)` a source that the backend can read. Returns
/// the facts of all clouds together.
template <class On, class PartView, class Clouds, class Answer, class Here>
frames::frame_facts plain_pass(const On& on, const model_view<PartView>& model,
                               std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer,
                               point_counts* counts, const Here& here) {
  const auto parts = std::uint32_t(model.size());
  const any_depth walk{stack_need(model.depth, model.width)};
  auto dropped = on.template make_scratch<drop_counts>(1);
  const drop_counts start;
  on.stage(std::span(&start, 1), dropped.data());
  frames::cloud_frame frame;
  const std::uint64_t seen = frames::for_each_turn(
      frame, model.facts, poses, clouds, [&]<point_source S>(const S& anywhere, const frames::turn& now) {
        const S source = here(anywhere, now.cloud);
        auto places = on.template make_scratch<frames::placement>(parts);
        on.stage(std::span<const frames::placement>(frame.places), places.data());
        const auto its = answer(source, now);
        on.for_ranges(source.size(), scan_body<PartView, S, any_depth, std::remove_const_t<decltype(its)>>{
                                         model.parts, places.data(), parts, source, frame.origin, now.first,
                                         dropped.data(), its, walk});
      });
  on.for_each(1, [from = dropped.data(), counts, seen](std::size_t) { count(*counts, from->dropped, seen); });
  return frame;
}

}  // namespace clearance::scan
