// SPDX-License-Identifier: BSD-3-Clause
// Room that no camera sees: pairs of a capsule and a part, and tangents to every part.
#include "emulated/asked.hpp"

#include <clearance/questions/unseen.hpp>

namespace emulated_test {

static void put(record& to, const std::string& what, const clearance::unseen_result& r) {
  put(to, what, r.all);
  put(to, what + ", own shadow", r.own_shadow);
  for (const clearance::unseen_part& p : r.parts)
    to.put(what + ", part", p.part, p.cloud, p.point, p.primitive, p.distance, p.lower, p.out_of_view);
}

namespace {

template <class V, class P>
void scenes_of(record& to) {
  for (const auto& s : small_scenes<P>(100)) {
    const sources<P> all(s);
    const auto model = model_of<V>(s);
    const placed first{all.raw, all.camera_pose}, second{all.raw, all.camera_pose * shifted(0.2 * s.size, 0, 0)};
    put(to, s.name, ask(here, model, s.poses, first, clearance::unseen{}));
    put(to, s.name + ", places", ask(here, model, s.poses, first, clearance::unseen{.places = true}));
    put(to, s.name + ", two cameras", ask(here, model, s.poses, std::vector{first, second}, clearance::unseen{}));
  }
}

void all(record& to) {
  scenes_of<clearance::sphere, inner_sphere>(to);
  scenes_of<clearance::obb, triangle>(to);
}

const asks asked("unseen", all);

}  // namespace

}  // namespace emulated_test
