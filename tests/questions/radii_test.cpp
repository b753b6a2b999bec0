// SPDX-License-Identifier: BSD-3-Clause
// Radii of points and parts: every question is on the safe side of a plain loop, wherever points and parts are within
// them; and a part's radius is a tolerance.
#include "questions/uncertain_scenes.hpp"
#include "support/closed.hpp"
#include "support/configurations.hpp"

#include <clearance/make_model.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace radii_test {

using namespace testing;
using clearance::host, clearance::in_collision, clearance::in_collisions, clearance::min_distances,
    clearance::min_distances_per_part, clearance::placed, clearance::point_span, clearance::state, clearance::uncertain,
    clearance::zones;

namespace {

/// The same robot, whose parts have radii as tolerances.
template <class V, class P>
auto tolerant(const scene<P>& s, const std::vector<double>& radii) {
  std::vector<clearance::part<clearance::bvh<V, P>>> parts;
  for (std::size_t k = 0; k < s.parts.size(); ++k)
    parts.push_back(clearance::make_part(clearance::build<V>(s.parts[k], {}, clearance::wrapped{}), 0, radii[k]));
  return clearance::model(std::move(parts));
}

/// in_collision and zones against all pairs, and against samples of what may be there.
template <class V, class P>
void thresholds_hold(std::size_t most_points) {
  verdict v;
  std::size_t states[4] = {};
  unsigned seed = 100;
  for (const auto& each : scenes<P>()) {
    const double scale = ++seed % 2 == 0 ? 0.02 : 0.2;
    const uncertain_scene<P> u(each, seed, scale);
    const auto& s = u.s;
    const auto source = u.source();
    std::vector<placed<std::remove_const_t<decltype(source)>>> vague{{source, s.cloud_pose},
                                                                     {source, shifted(0.1, 0, 0) * s.cloud_pose}};
    const std::vector<placed<point_span>> bare{{source.source, vague[0].pose}, {source.source, vague[1].pose}};
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto radii = u.radii_of_parts();
    const auto by_tolerance = tolerant<V>(s, radii);
    const bool fine = s.name != "far from the origin" && s.name != "sizes";
    const auto check = [&](const auto& all, const auto& least, bool certain) {
      dice d(seed);
      std::vector<wide> its, nearest(s.parts.size(), infinity);
      for (std::size_t k = 0; k < least.size(); ++k) its.push_back(wide(least[k].distance) - radii[k]);
      for (int n = 0; n < 2 && s.points.size() <= most_points; ++n) {
        const auto some = truths(s, all, radii, d);
        for (std::size_t k = 0; k < its.size(); ++k) nearest[k] = std::min(nearest[k], some[k]);
      }
      for (const double share : {0.0, 0.05, 1.0}) {
        const double margin = share * s.size;
        const std::string what = s.name + ", scale " + std::to_string(scale) + ", within " + std::to_string(margin);
        const in_collision asked{{margin}, radii};
        const auto r = ask(host{}, model, s.poses, all, asked);
        v.require(same_answer(r, ask(host{2}, model, s.poses, all, asked)), what, ": two threads");
        v.require(same_answer(r, ask(host{}, by_tolerance, s.poses, all, in_collision{{margin}})), what,
                  ": a radius is no tolerance");
        ++states[int(r.state)];
        if (r.state == state::no_data) continue;
        const wide lower = std::ranges::min(its), is = std::ranges::min(nearest);
        v.require(r.state != state::free || (lower > margin && is >= margin), what, ": free, but", lower);
        v.require(r.state != state::collision || (certain && (is <= margin || is == infinity)), what,
                  ": in collision, but", is);
        v.require(!fine || r.state == state::free || lower < 1.001L * margin + 1e-3L * s.size, what, ": not free, but",
                  lower);
        const zones around{.thresholds = {margin, 2 * margin + 0.1}, .radii = radii};
        const auto z = ask(host{}, model, s.poses, all, around);
        v.require(same_answer(z, ask(host{}, by_tolerance, s.poses, all, zones{around.thresholds})), what,
                  ": a radius is no tolerance in zones");
        for (std::size_t k = 0; k < its.size(); ++k)
          for (std::size_t n = 0; n < 2; ++n) {
            const auto& zone = z.of(k, n);
            v.require(zone.points != 0 || its[k] > around.thresholds[n], what, ": zone", n, " is empty");
            const real off = std::abs(zone.nearest - least[k].distance);  // what nearly touches is 0 away
            v.require(zone.points == 0 || off <= 1e-6 * (s.size + std::abs(zone.nearest)), what, ": zone", n, " has",
                      zone.nearest, " and not", least[k].distance);
          }
      }
    };
    check(vague, least_certain(s, vague), false);
    std::vector<clearance::part_minimum> least(s.parts.size());
    for_each_pair(s, bare, [&](const clearance::pair_distance& pair) {
      if (pair.distance < least[pair.part].distance) least[pair.part].distance = pair.distance;
    });
    check(bare, least, true);
  }
  CHECK((states[int(state::free)] > 5 && states[int(state::possible)] > 20 && states[int(state::collision)] > 2));
}

/// Many configurations are each alone, to the bit; and their radii are tolerances.
template <class Model, class Tolerant, class Clouds>
void check_configurations(const Model& model, const Tolerant& by_tolerance, std::size_t parts,
                          const configurations& poses, const Clouds& clouds, double size,
                          const std::vector<double>& radii, verdict& v, const std::string& what) {
  clearance::query query(host{}, model, min_distances{});
  const auto one = [&](auto own) { return ask(host{1}, model, own, clouds, clearance::min_distance{}); };
  const auto own_tolerance = [&](auto own) {
    return ask(host{1}, by_tolerance, own, clouds, clearance::min_distance{});
  };
  const double spread = std::ranges::max(radii) - std::ranges::min(radii);
  for (const double d_max : {-0.05, 0.2, double(infinity)}) {
    const real most = real(d_max * size);
    const std::string which = what + ", d_max " + std::to_string(most);
    require_same(query(poses, clouds, {most}), poses, parts, most, one, v, which);
    require_same(query(poses, clouds, {most, radii}), poses, parts, most, own_tolerance, v, which + ", radii", spread);
    require_same(query(poses, clouds, {most}), poses, parts, most, one, v, which + ", again without");
    require_same(
        ask(clearance::plain{host{1}, clearance::near_first{}}, model, poses, clouds, min_distances{most, radii}),
        poses, parts, most, own_tolerance, v, which + ", one by one", spread);
  }
  const auto each = ask(host{}, model, poses, clouds, min_distances_per_part{infinity, radii});
  for (std::size_t c = 0; c < each.size(); ++c)
    for (std::size_t k = 0; k < parts; ++k) {
      auto its = ask(host{1}, by_tolerance.view().part(k), std::span(poses).subspan(c * parts + k, 1), clouds,
                     clearance::min_distance{});
      if (its.part != none) its.part = std::uint32_t(k);
      v.require(same_result(each.of(c)[k], its), what, ": part", k, " of configuration", c);
    }
  for (const double margin : {0.0, 0.1, 0.5}) {
    const auto states = ask(host{2}, model, poses, clouds, in_collisions{{margin * size}, radii});
    for (std::size_t c = 0; c < states.of.size(); ++c) {
      const auto expected =
          ask(host{1}, model, std::span(poses).subspan(c * parts, parts), clouds, in_collision{{margin * size}, radii});
      v.require(states.of[c] == expected.state, what, ": configuration", c, " is", to_string(states.of[c]), " and not ",
                to_string(expected.state));
    }
  }
}

template <class V, class P>
void configurations_hold() {
  verdict v;
  dice d(431);
  unsigned seed = 200;
  for (const auto& each : scenes<P>()) {
    const uncertain_scene<P> u(each, ++seed, 0.1);
    const auto& s = u.s;
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto radii = u.radii_of_parts();
    const auto by_tolerance = tolerant<V>(s, radii);
    const auto poses = configurations_of(s, d, 5);
    const placed cloud{u.source(), s.cloud_pose};
    check_configurations(model, by_tolerance, s.parts.size(), poses, cloud, s.size, radii, v, s.name);
    const std::tuple several{placed{point_span(s.points), shifted(0.3, 0, 0) * s.cloud_pose}, cloud,
                             placed{uncertain(point_span(s.points), clearance::tof_noise{0.01f, 0.001f}),
                                    shifted(100, 0, 0) * s.cloud_pose}};
    check_configurations(model, by_tolerance, s.parts.size(), poses, several, s.size, radii, v, s.name + ", several");
    const auto fields = clearance::with_fields(host{}, model, {1 << 14});
    check_configurations(fields.model, by_tolerance, s.parts.size(), poses, cloud, s.size, radii, v,
                         s.name + ", by fields");
  }
}

}  // namespace

TEST_CASE("Within all radii nothing is nearer to spheres than a margin or a zone that is said to be free") {
  thresholds_hold<clearance::sphere, inner_sphere>(300);
}
TEST_CASE("Within all radii nothing is nearer to triangles than a margin or a zone that is said to be free") {
  thresholds_hold<clearance::aabb, triangle>(200);
}

TEST_CASE("Many configurations of spheres with radii are each alone, and a radius is a tolerance") {
  configurations_hold<clearance::sphere, inner_sphere>();
}
TEST_CASE("Many configurations of triangles with radii are each alone, and a radius is a tolerance") {
  configurations_hold<clearance::aabb, triangle>();
}

TEST_CASE("So they are of solids, in whose inside balls are 0 away") {
  verdict v;
  dice d(12);
  const auto closed = closed_scene(12);
  const auto model = clearance::make_model<clearance::obb>(closed.meshes);
  const std::size_t parts = closed.meshes.size();
  for (int round = 0; round < 6; ++round) {
    auto points = d.points(round < 3 ? 40 : 2000, 1);
    if (round == 5)
      for (vec3& p : points) p = p + vec3{200, 0, 0};
    std::vector<real> of_points;
    for (std::size_t i = 0; i < points.size(); ++i) of_points.push_back(d.below(3) == 0 ? 0 : d.number(0, 0.1));
    const uncertain source{point_span(points), clearance::point_radii(of_points.data(), of_points.size())};
    const placed cloud{source, round == 5 ? shifted(-200, 0, 0) : d.pose(0.5)};
    configurations poses;
    for (int c = 0; c < 8; ++c)
      for (const auto& pose : closed.poses) poses.push_back(d.pose(0.7) * pose);
    std::vector<double> radii;
    for (std::size_t k = 0; k < parts; ++k) radii.push_back(d.uniform(0, 0.05));
    const std::string what = "round " + std::to_string(round);
    clearance::query query(host{}, model, min_distances{});
    const auto one = [&](auto own) { return ask(host{1}, model, own, cloud, clearance::min_distance{}); };
    for (const double d_max : {-0.05, 0.2, double(infinity)})
      require_same(query(poses, cloud, {d_max}), poses, parts, real(d_max), one, v, what);
    for (const double margin : {0.0, 0.05, 0.3}) {
      const auto states = ask(host{}, model, poses, cloud, in_collisions{{margin}, radii});
      for (std::size_t c = 0; c < states.of.size(); ++c)
        v.require(states.of[c] == ask(host{1}, model, std::span(poses).subspan(c * parts, parts), cloud,
                                      in_collision{{margin}, radii})
                                      .state,
                  what, ": configuration", c);
    }
    const auto wider = query(poses, cloud, {infinity, radii}), bare = query(poses, cloud, {infinity});
    for (std::size_t c = 0; c < wider.of.size(); ++c)
      v.require(same_bits(wider.of[c].distance, bare.of[c].distance) && wider.of[c].lower <= bare.of[c].lower &&
                    wider.of[c].upper >= bare.of[c].upper,
                what, ": a bracket of radii is narrower in configuration", c);
  }
}

TEST_CASE("At no time of a motion is anything nearer, wherever points and parts are within their radii") {
  verdict v;
  dice d(78);
  std::size_t free = 0, collides = 0;
  for (int trial = 0; trial < 20; ++trial) {
    scene<inner_sphere> s{"", {}, {}, d.points(trial % 2 == 0 ? 8 : 200, 2)};
    for (int k = 0; k < 3; ++k) {
      s.parts.push_back(random_spheres(d, 12, 0.2, 0.05));
      s.poses.push_back(d.pose(0.7));
    }
    std::vector<Eigen::Isometry3d> to;
    for (const auto& pose : s.poses) to.push_back(shifted(0.3, 0.1, -0.2) * pose);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const clearance::straight_motion motion(s.poses, to);
    const std::vector<double> radii{d.uniform(0, 0.05), 0, d.uniform(0, 0.1)};
    const clearance::motion_clearance_options asked{.tolerance = 0.004, .margin = 0.05, .radii = radii};
    const auto check = [&](const auto& source) {
      const std::vector clouds{placed{source}};
      const auto r = motion_clearance(host{}, model, motion, clouds, asked);
      wide at_its_time = infinity;
      for (int i = 0; i <= 20; ++i) {
        scene<inner_sphere> now = s;
        now.poses = motion.at(i == 20 ? r.time : i / 20.0, model.view().facts).poses;
        const wide is = std::ranges::min(truths(now, clouds, radii, d));
        v.require(r.lower <= is, "trial", trial, ": lower", r.lower, " but at a time", is);
        if (i == 20) at_its_time = is;
      }
      v.require(r.upper >= at_its_time, "trial", trial, ": upper", r.upper, " of", at_its_time);
      v.require(r.state != state::collision || at_its_time <= asked.margin, "trial", trial, ": in collision");
      v.require((r.state == state::free) == (r.lower > asked.margin), "trial", trial, ": free, or not");
      free += r.state == state::free, collides += r.state == state::collision;
      return r;
    };
    check(point_span(s.points));
    const uncertain vague(point_span(s.points), clearance::lidar_noise{0.005f, 0.002f});
    const auto r = check(vague);
    v.require(r.upper == infinity && r.state != state::collision, "trial", trial, ": certain of what is not");
  }
  INFO(free << " free, " << collides << " in collision");
  CHECK((free > 4 && collides > 0));
}

TEST_CASE("If a point may be anywhere, no configuration and no motion is free") {
  dice d(15);
  const scene<inner_sphere> s{"", {random_spheres(d, 20, 0.1, 0.02)}, {shifted(0, 0, 3)}, d.points(500, 1)};
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const configurations poses{shifted(0, 0, 3), shifted(0, 0, 4)};
  const clearance::straight_motion motion({&poses[0], 1}, {&poses[1], 1});
  std::vector<real> radii(500, 0.01f);
  for (const real bad : {0.01f, -1.0f, clearance::not_a_number, infinity}) {
    radii[123] = bad;
    const placed cloud{uncertain{point_span(s.points), clearance::point_radii(radii.data(), radii.size())}};
    const state expected = bad == 0.01f ? state::free : state::possible;
    for (const double d_max : {0.1, double(infinity)})
      for (const auto& r : ask(host{}, model, poses, cloud, min_distances{d_max}).of)
        CHECK((r.state == expected && (r.lower > 0) == (expected == state::free)));
    for (const state its : ask(host{}, model, poses, cloud, in_collisions{{0.1}}).of) CHECK(its == expected);
    CHECK(motion_clearance(host{}, model, motion, cloud).state == expected);
  }
}

TEST_CASE("Radii that cannot be are refused with a sentence") {
  using Catch::Matchers::Contains;
  const scene<inner_sphere> s{
      "two", {{{{0, 0, 0}, 0.1f}}, {{{0, 0, 0}, 0.1f}}}, {shifted(0, 0, 1), shifted(1, 0, 1)}, {}};
  const std::vector<vec3> points(3);
  const std::vector<float> pixels(12, 1.0f);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto refused = [&](const std::vector<double>& radii, const std::string& why) {
    const auto with = [&](const auto& question, const auto& cloud) {
      CHECK_THROWS_WITH(ask(host{}, model, s.poses, cloud, question), Contains(why));
    };
    with(in_collision{{0}, radii}, points), with(zones{.thresholds = {0.1}, .radii = radii}, points);
    with(min_distances{infinity, radii}, points), with(min_distances_per_part{infinity, radii}, points);
    with(in_collisions{{0}, radii}, points);
    with(clearance::unseen{.radii = radii}, clearance::depth_image<float>(pixels.data(), 4, 3, {4, 4, 2, 1.5}));
    const clearance::straight_motion still(s.poses, s.poses);
    CHECK_THROWS_WITH(motion_clearance(host{}, model, still, points, {.radii = radii}), Contains(why));
  };
  refused({0.1, 0.1, 0.1}, "2 parts, but 3 radii of parts");
  for (const double bad : {-1e-9, double(clearance::not_a_number), double(infinity)})
    refused({bad}, "a part's radius"), refused({0, bad}, "a part's radius");
}

}  // namespace radii_test
