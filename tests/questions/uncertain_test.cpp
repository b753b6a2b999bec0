// SPDX-License-Identifier: BSD-3-Clause
// What is certain of a distance is what a plain loop over all pairs says, wherever points and parts are within their
// radii.
#include "questions/uncertain_scenes.hpp"

#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace uncertain_test {

using namespace testing;
using clearance::host, clearance::placed, clearance::point_span, clearance::state, clearance::uncertain;

namespace {

/// The same formula, but it does not say how large it is in a box.
template <class N>
struct without_most {
  N noise;
  real operator()(std::size_t i, vec3 p) const { return noise(i, p); }
};

template <class V, class P>
void all_scenes(std::size_t most_points) {
  verdict v;
  std::size_t other = 0, free = 0;
  unsigned seed = 0;
  for (const auto& each : scenes<P>())
    for (const double scale : {0.02, 0.3}) {
      const uncertain_scene<P> u(each, ++seed, scale);
      const auto& s = u.s;
      const auto source = u.source();
      std::vector<placed<std::remove_const_t<decltype(source)>>> all{{source, s.cloud_pose},
                                                                     {source, shifted(0.1, 0, 0) * s.cloud_pose}};
      const std::string what = s.name + ", scale " + std::to_string(scale);
      const auto model = make_model<V>(s, {}, clearance::wrapped{});
      const auto r = ask(host{}, model, s.poses, all, certain_distance{u.parts});
      v.require(same_answer(ask(host{2}, model, s.poses, all, certain_distance{u.parts}), r), what, ": two threads");
      const std::vector<placed<point_span>> bare{{source.source, all[0].pose}, {source.source, all[1].pose}};
      v.require(same_result(r.nominal, ask(host{}, model, s.poses, bare, clearance::min_distance{})), what,
                ": nominal");
      const auto least = least_certain(s, all);
      wide lower = infinity;
      for (std::uint32_t k = 0; k < least.size(); ++k) {
        const auto& got = r.parts[k];
        v.require(got.cloud == least[k].cloud && got.point == least[k].point && got.primitive == least[k].primitive,
                  what, ": part", k, " has point", got.point, " instead of", least[k].point);
        if (got.part == none) continue;
        const wide its = wide(least[k].distance) - u.parts[k].sum();
        const wide size =
            std::abs(wide(got.distance)) + source.around(got.point, s.points[got.point]).radius + std::abs(its);
        v.require(got.lower <= std::max(its, wide(0)) &&
                      std::abs(got.distance - got.shares.sum() - its) <= got.shares.rounding + 1e-6 * size,
                  what, ": part", k, " is at least", got.lower, " away, by the shares", got.distance - got.shares.sum(),
                  " and the loop says", its);
        lower = std::min(lower, its);
      }
      if (r.nominal.part == none) {
        v.require(r.state == state::no_data && r.lower == 0 && r.upper == infinity, what, ": no data");
        continue;
      }
      v.require(r.lower <= std::max(lower, wide(0)) && same_bits(r.certain.lower, r.lower), what, ": lower", r.lower);
      v.require((r.state == state::free) == (r.lower > 0), what, ": state");
      if (s.name != "far from the origin" && s.name != "sizes")
        v.require(lower < 0.01 || r.lower > lower * 0.999L - 1e-4L * s.size, what, ": lower", r.lower, " is not",
                  lower);
      free += r.state == state::free;
      other +=
          r.certain.point != r.nominal.point || r.certain.cloud != r.nominal.cloud || r.certain.part != r.nominal.part;
      dice d(seed);
      for (int k = 0; k < 3 && s.points.size() <= most_points; ++k) {
        const wide is = std::ranges::min(truths(s, all, u.radii_of_parts(), d));
        v.require(r.lower <= is && is <= r.upper, what, ": the bracket", r.lower, " to", r.upper, " misses", is);
      }
    }
  CHECK((other > 8 && free > 4));
}

}  // namespace

TEST_CASE("What is certain of spheres' distances is what all pairs say, and the bracket holds within all radii") {
  all_scenes<clearance::sphere, inner_sphere>(600);
}
TEST_CASE("What is certain of triangles' distances is what all pairs say, and the bracket holds within all radii") {
  all_scenes<clearance::aabb, triangle>(300);
}

TEST_CASE("The pair that is certainly least far away may be another than the nearest, and its shares say why") {
  scene<inner_sphere> s{"two points",
                        {{{{0, 0, 0}, 0.1f}}, {{{0, 0, 0}, 0.1f}}},
                        {shifted(0, 0, 0), shifted(9, 0, 0)},
                        {{0.5f, 0, 0}, {0, 0, 0.6f}}};
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const std::vector<real> radii{0, 0.3f};
  const uncertain source(point_span(s.points), clearance::point_radii(std::span(radii)), {0.01, 0.02, 0.5, 0.1});
  const auto r = ask(host{}, model, s.poses, placed{source}, certain_distance{{{0.01, 0.02}, {0, 0}}});
  const auto near = [](double a, double b) { return std::abs(a - b) < 1e-5; };
  CHECK((r.nominal.point == 0 && near(r.nominal.distance, 0.4)));
  CHECK((r.certain.point == 1 && r.certain.part == 0 && near(r.certain.distance, 0.5)));
  CHECK((near(r.certain.shares.noise, 0.3) && near(r.certain.shares.calibration, 0.022) &&
         near(r.certain.shares.time, 0.05) && near(r.certain.shares.joints, 0.01) &&
         near(r.certain.shares.delay, 0.02)));
  CHECK((near(r.lower, 0.5 - 0.3 - 0.022 - 0.05 - 0.03) && r.state == state::free));
  CHECK(near(r.upper - r.nominal.upper, 0.01 + 0.01 + 0.05 + 0.03));
  CHECK((near(r.parts[1].distance, 8.4) && r.parts[1].point == 0));
}

TEST_CASE("Without radii, what is certain is min_distance's bracket, and of bare clouds also its state") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    const auto r = ask(host{}, model, s.poses, two, certain_distance{});
    const auto parts = ask(host{}, model, s.poses, two, clearance::min_distance_per_part{});
    v.require(same_result(r.nominal, ask(host{}, model, s.poses, two, clearance::min_distance{})) &&
                  r.state == r.nominal.state && same_bits(r.upper, r.nominal.upper) && r.lower >= parts.all.lower,
              s.name);
  }
}

TEST_CASE("Larger radii make nothing clearer") {
  verdict v;
  const auto rank = [](state a) { return a == state::free ? 0 : a == state::possible ? 1 : 2; };
  for (const auto& each : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(each, {}, clearance::wrapped{});
    real lower = infinity, upper = 0;
    std::size_t innermost = 3, points = 0;
    int collides = 0;
    for (const double shift : {0.0, 0.001, 0.03, 0.5, 100.0}) {
      const uncertain source(point_span(each.points), clearance::no_noise{}, {shift * each.size, 0, 0, 0});
      const placed cloud{source, each.cloud_pose};
      const auto r = ask(host{}, model, each.poses, cloud, certain_distance{});
      const auto z = ask(host{}, model, each.poses, cloud, clearance::zones{{0, 0.1 * each.size, each.size}});
      const auto hit = ask(host{}, model, each.poses, cloud, clearance::in_collision{});
      std::size_t inside = 0;
      for (const auto& one : z.zones) inside += one.points;
      v.require(r.lower <= lower && r.upper >= upper && z.innermost() <= innermost && inside >= points, each.name,
                ": clearer at", shift);
      v.require(hit.state == state::no_data || (rank(hit.state) >= collides && hit.state != state::collision),
                each.name, ": less in collision, or certainly so, at", shift);
      lower = r.lower, upper = r.upper, innermost = z.innermost(), points = inside, collides = rank(hit.state);
    }
  }
}

TEST_CASE("A point without a radius that is one may be anywhere, and nothing is free") {
  dice d(5);
  scene<inner_sphere> s{"one bad", {random_spheres(d, 20, 0.1)}, {shifted(0, 0, 3)}, d.points(500, 1)};
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  s.points[123] = {0, 0, 1.5f};  // the nearest
  for (const real bad : {-1e-6f, clearance::not_a_number, infinity, 1e7f, -infinity}) {
    std::vector<real> radii(500, 0.01f);
    radii[123] = bad;
    const uncertain source(point_span(s.points), clearance::point_radii(radii.data(), radii.size()));
    const auto r = ask(host{}, model, s.poses, placed{source}, certain_distance{});
    CHECK((r.nominal.point == 123 && r.upper == infinity && r.anywhere == 1));
    CHECK((r.state == state::possible && r.lower == 0 && r.parts[0].lower == 0 && r.nominal.state == state::free));
    CHECK(ask(host{}, model, s.poses, placed{source}, clearance::in_collision{}).state == state::possible);
    CHECK(ask(host{}, model, s.poses, placed{source}, clearance::zones{{0.1, 0.2}}).innermost() == 0);
    if (bad == bad && bad < infinity && bad > 0) continue;
    CHECK_THROWS_WITH(clearance::point_radii(std::span<const real>(radii)),
                      Catch::Matchers::Contains("the radius of point 123"));
  }
}

TEST_CASE("A deviation that is larger than the distance leaves nothing certain but the upper end") {
  const std::vector<vec3> points{{0, 0, 2}};
  scene<inner_sphere> s{"noisy", {{{{0, 0, 0}, 0.1f}}}, {shifted(0, 0, 1.5)}, points};
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const uncertain source(point_span(points), clearance::stereo_noise{500, 0.05f, 5});
  const auto r = ask(host{}, model, s.poses, placed{source}, certain_distance{});
  CHECK((r.state == state::possible && r.lower == 0 && r.upper > 2 && r.certain.shares.noise > r.certain.distance));
}

TEST_CASE("Tiles that are passed over by their largest radius change nothing, and no radius is larger") {
  verdict v;
  dice d(13);
  std::vector<float> pixels(256 * 96);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = i % 97 == 0 ? 0 : real(1.5 + 0.5 * std::sin(double(i % 256) / 30) + d.uniform(0, 0.02));
  const clearance::depth_image<float> image(pixels.data(), 256, 96, {200, 200, 128, 48});
  std::vector<real> radii(pixels.size());
  for (std::size_t i = 0; i < radii.size(); ++i) radii[i] = d.below(500) == 0 ? 0.5f : 0.01f;
  scene<inner_sphere> s{"", {}, {}, {}};
  for (int k = 0; k < 4; ++k) {
    s.parts.push_back(random_spheres(d, 20, 0.1, 0.03));
    s.poses.push_back(shifted(d.uniform(-0.5, 0.5), d.uniform(-0.3, 0.3), d.uniform(0.5, 2)));
  }
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto check = [&](const auto& noise) {
    const cloud_uncertainty off{0.003, 0.002, 1, 0.03};
    const uncertain quick(image, noise, off);
    const uncertain slow(image, without_most{noise}, off);
    const auto r = ask(host{}, model, s.poses, placed{quick}, certain_distance{});
    v.require(same_answer(r, ask(host{}, model, s.poses, placed{slow}, certain_distance{})), "another answer");
    const auto least = least_certain(s, std::vector{placed{quick}});
    for (std::size_t k = 0; k < least.size(); ++k)
      v.require(r.parts[k].point == least[k].point, "part", k, " has point", r.parts[k].point, " of", least[k].point);
    for (std::size_t begin = 0; begin + 128 <= pixels.size(); begin += 128) {
      clearance::extent box, ends;
      std::uint32_t dropped[clearance::drop_reasons] = {};
      real widest = 0;
      if (!quick.survey_capsules(begin, box, ends, widest, dropped)) continue;
      for (std::size_t i = begin; i < begin + 128; ++i)
        if (const auto p = quick[i]; p.valid())
          v.require(quick.around(i, p.position).radius <= widest, "a radius of", quick.around(i, p.position).radius,
                    " above", widest);
    }
  };
  check(clearance::kinect_noise{}), check(clearance::stereo_noise{200, 0.05f, 0.1f});
  check(clearance::tof_noise{0.004f, 0.003f}), check(clearance::lidar_noise{0.01f, 0.004f}),
      check(clearance::no_noise{});
  check(clearance::point_radii(std::span<const real>(radii)));
  clearance::any_noise any;
  for (const auto kind : {clearance::noise_kind::none, clearance::noise_kind::kinect, clearance::noise_kind::stereo,
                          clearance::noise_kind::tof, clearance::noise_kind::lidar, clearance::noise_kind::radii}) {
    any.kind = kind, any.stereo = {200, 0.05f, 0.1f}, any.tof = {0.004f, 0.003f}, any.lidar = {0.01f, 0.004f};
    any.radii = clearance::point_radii(std::span<const real>(radii));
    check(any);
  }
}

TEST_CASE("A depth image's reading may be wrong along z by k sigma, and its point stays in the ball") {
  verdict v;
  dice d(7);
  const clearance::intrinsics camera{300, 310, 80, 60};
  const auto check = [&](const auto& noise, auto sigma) {
    for (int k = 0; k < 2000; ++k) {
      std::vector<float> pixels(160 * 120, d.number(0.3, 8));
      const std::size_t i = d.below(160 * 120);
      const clearance::depth_image<float> image(pixels.data(), 160, 120, camera);
      const uncertain source(image, noise);
      const vec3 p = source[i].position, way = image.way(i);
      const wide z = pixels[i] + 3 * sigma(wide(pixels[i])) * wide(d.uniform(-1, 1));
      const wide off = oracle::between(wider(p), z * wider(way));
      v.require(off <= source.around(i, p).radius + 1e-6L, "moved by", off);
      v.require(source.around(i, p).radius <= 3.001L * sigma(wide(pixels[i])) * oracle::length(wider(way)), "too wide");
    }
  };
  check(clearance::kinect_noise{}, [](wide z) { return 0.0012L + 0.0019L * (z - 0.4L) * (z - 0.4L); });
  check(clearance::stereo_noise{424, 0.05f, 0.08f}, [](wide z) { return z * z * 0.08L / (424 * 0.05L); });
}

TEST_CASE("What uncertain cameras may hide is nearer than what they hide, and it is so by their radii") {
  dice d(11);
  verdict v;
  const clearance::intrinsics camera{60, 60, 31.5, 23.5};
  std::size_t nearer = 0;
  for (int round = 0; round < 30; ++round) {
    std::vector<float> pixels(64 * 48);
    for (float& z : pixels) z = d.below(20) == 0 ? 0 : d.number(1.5, 2);
    const clearance::depth_image<float> image(pixels.data(), 64, 48, camera);
    scene<inner_sphere> s{"", {random_spheres(d, 10, 0.2), random_spheres(d, 10, 0.2)}, {}, {}};
    for (int k = 0; k < 2; ++k)
      s.poses.push_back(shifted(d.uniform(-0.2, 0.2), d.uniform(-0.2, 0.2), d.uniform(0.6, 1.2)));
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const clearance::unseen asked{{.nearest = 1.4f}};
    const auto bare = ask(host{}, model, s.poses, placed{image}, asked);
    real lower = bare.all.lower;
    for (const double shift : {0.0, 0.01, 0.1, 1.0}) {
      const uncertain source(image, clearance::kinect_noise{}, {shift, 0, 0, 0});
      const auto r = ask(host{2}, model, s.poses, placed{source}, asked);
      const real off = bare.all.distance - r.all.distance;
      v.require(r.all.lower <= lower && off >= shift - 1e-5 && off <= shift + 0.03, "shift", shift, " takes", off);
      v.require(r.parts[0].lower <= bare.parts[0].lower && r.parts[1].lower <= bare.parts[1].lower,
                "a part is clearer");
      lower = r.all.lower, nearer += r.all.state == state::free;
      const uncertain turned(image, clearance::kinect_noise{}, {shift, 0.05, 0, 0});
      v.require(ask(host{}, model, s.poses, placed{turned}, asked).all.lower <= lower, "a turn is clearer");
    }
    for (const real k : {clearance::not_a_number, -1.0f}) {
      std::vector<real> radii(pixels.size(), 0.001f);
      radii[40] = k;
      const uncertain source(image, clearance::point_radii(radii.data(), radii.size()));
      const auto r = ask(host{}, model, s.poses, placed{source}, asked);
      v.require(r.all.lower == 0 && r.all.state != state::free && r.parts[0].lower == 0, "free by a bad radius");
    }
  }
  CHECK(nearer > 10);
}

TEST_CASE("Options that cannot be are refused with a sentence that names them") {
  using Catch::Matchers::Contains;
  const std::vector<vec3> points(3);
  const point_span span(points);
  const std::vector<real> two(2);
  for (const double bad : {-0.1, double(clearance::not_a_number), double(infinity)}) {
    CHECK_THROWS_WITH(uncertain(span, clearance::no_noise{}, {bad, 0, 0, 0}), Contains("a sensor's shift"));
    CHECK_THROWS_WITH(uncertain(span, clearance::no_noise{}, {0, bad, 0, 0}), Contains("a sensor's turn"));
    CHECK_THROWS_WITH(uncertain(span, clearance::no_noise{}, {0, 0, bad, 1}), Contains("greatest speed"));
    CHECK_THROWS_WITH(uncertain(span, clearance::no_noise{}, {0, 0, 1, bad}), Contains("age"));
    CHECK_THROWS_WITH(uncertain(span, clearance::kinect_noise{real(bad)}), Contains("the noise's k"));
    CHECK_THROWS_WITH(uncertain(span, clearance::stereo_noise{1, 1, real(bad)}), Contains("disparity"));
    CHECK_THROWS_WITH(uncertain(span, clearance::stereo_noise{real(bad), 1, 1}), Contains("focal length"));
    CHECK_THROWS_WITH(uncertain(span, clearance::tof_noise{real(bad), 1}), Contains("constant"));
    CHECK_THROWS_WITH(uncertain(span, clearance::lidar_noise{0, real(bad)}), Contains("grows by"));
  }
  CHECK_THROWS_WITH(uncertain(span, clearance::point_radii(std::span(two))), Contains("3 points, but 2 radii"));
  scene<inner_sphere> s{"one", {{{{0, 0, 0}, 0.1f}}}, {shifted(0, 0, 1.5)}, points};
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  CHECK_THROWS_WITH(ask(host{}, model, s.poses, placed{span}, certain_distance{{{}, {}}}),
                    Contains("1 parts, but 2 radii"));
  CHECK_THROWS_WITH(ask(host{}, model, s.poses, placed{span}, certain_distance{{{-1, 0}}}), Contains("by its joints"));
}

}  // namespace uncertain_test
