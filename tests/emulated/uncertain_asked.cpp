// SPDX-License-Identifier: BSD-3-Clause
// Points that may be elsewhere, and full balls: certain distances, whole and in pieces, frame after frame.
#include "emulated/asked.hpp"

#include <clearance/points/uncertain.hpp>
#include <clearance/questions/certain_distance.hpp>

namespace emulated_test {

using clearance::certain_distance;

static void put(record& to, const std::string& what, const clearance::certain_pair& p) {
  to.put(what, p.distance, p.part, p.cloud, p.point, p.primitive, p.at.x, p.at.y, p.at.z, p.nearest.x, p.nearest.y,
         p.nearest.z, p.normal.x, p.normal.y, p.normal.z, p.lower, p.to_ball);
  const clearance::uncertainty_shares& s = p.shares;
  to.put(what + ", shares", s.noise, s.calibration, s.time, s.joints, s.delay, s.gap, s.balls, s.rounding);
}
static void put(record& to, const std::string& what, const clearance::certain_distance_result& r) {
  to.put(what, r.state, r.lower, r.upper, r.anywhere, r.any_radius);
  put(to, what + ", as measured", r.nominal);
  put(to, what + ", certain", r.certain);
  for (const auto& part : r.parts) put(to, what + ", part", part);
}

namespace {

template <class V, class P>
void frames_of(record& to, std::size_t parts, const std::string& name) {
  dice d(31);
  scene<P> s{name, {}, {}, {}};
  certain_distance q;
  for (std::size_t k = 0; k < parts; ++k) {
    s.parts.push_back(random_primitives<P>(d, 20, 0.1, 0.05));
    s.poses.push_back(d.pose(1));
    q.parts.push_back({0.001 * double(k), 0.002});
  }
  const auto model = model_of<V>(s);
  clearance::query radii_asked(here, model, q), balls_asked(here, model, q);
  frame_after_frame(
      s.poses,
      [&](const char* when) {
        const auto points = d.points(900, 2), others = d.points(300, 2);
        std::vector<real> radii;
        for (std::size_t i = 0; i < points.size(); ++i) radii.push_back(d.below(3) == 0 ? 0 : d.number(0, 0.2));
        const auto around = [&](std::size_t first, std::size_t end) {
          return clearance::uncertain(point_span(points.data() + first, end - first),
                                      clearance::point_radii(radii.data() + first, end - first),
                                      {0.002, 0.001, 0.5, 0.02});
        };
        const clearance::sharded pieces(std::vector{around(0, 400), around(400, 401), around(401, points.size())});
        const std::string what = name + ", " + when;
        put(to, what,
            radii_asked(s.poses, std::tuple(placed{around(0, points.size()), shifted(0.1, 0, 0)},
                                            placed{point_span(others), d.pose(0.1)})));
        put(to, what + ", in pieces", radii_asked(s.poses, placed{pieces, shifted(0.1, 0, 0)}));
        const clearance::sharded spans(
            std::vector{point_span(points.data(), 500), point_span(points.data() + 500, 400)});
        put(to, what + ", around pieces",
            radii_asked(s.poses, placed{clearance::uncertain(spans, clearance::point_radii(radii.data(), radii.size())),
                                        shifted(0.1, 0, 0)}));
        const auto balls = clearance::balls_of(points, radii, 0.01);
        put(to, what + ", balls", balls_asked(s.poses, placed{balls, shifted(0.1, 0, 0)}));
        const clearance::in_device_memory marked(balls);
        const std::tuple uncertain_balls(
            placed{clearance::uncertain(balls, clearance::no_noise{}, {0.01, 0, 0, 0}), shifted(0.1, 0, 0)});
        put(to, what + ", balls that may be elsewhere", balls_asked(s.poses, uncertain_balls));
#if defined(__CUDA_ARCH__)
        put(to, what + ", balls in its memory", balls_asked(s.poses, placed{marked, shifted(0.1, 0, 0)}));
#else
        put(to, what + ", balls in its memory", balls_asked(s.poses, placed{balls, shifted(0.1, 0, 0)}));
#endif
      },
      [&] {
        radii_asked.forget();
        balls_asked.forget();
      });
}

void all(record& to) {
  frames_of<clearance::sphere, inner_sphere>(to, 3, "spheres");
  frames_of<clearance::sphere, inner_sphere>(to, 14, "many parts");
  frames_of<clearance::obb, triangle>(to, 3, "triangles");
}

const asks asked("uncertain", all);

}  // namespace

}  // namespace emulated_test
