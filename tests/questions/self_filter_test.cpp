// SPDX-License-Identifier: BSD-3-Clause
// The robot's own points are those that a plain loop over all points and primitives finds. Questions about the rest
// give the answers of clouds without them.
#include "support/brute_own.hpp"

#include <clearance/make_model.hpp>
#include <clearance/robot/attached.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace self_filter_test {

using namespace testing;
using clearance::host, clearance::min_distance, clearance::min_distance_filtered, clearance::placed,
    clearance::point_label, clearance::point_span, clearance::self_filter;

namespace {

template <class V, class P>
void all_scenes() {
  verdict v;
  std::size_t own = 0, uncertain = 0;
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    std::vector<std::vector<vec3>> kept;
    clearance::query prepared(host{}, model, self_filter{});
    for (const double padding : {0.0, 0.02, 0.4}) {
      std::vector<double> each(s.parts.size(), padding * s.size);
      const std::string what = s.name + ", padding " + std::to_string(padding);
      const auto all = ask(host{}, model, s.poses, two, self_filter{.padding = {each[0]}});
      require_same(all, brute_own(s, two, each), v, what);
      each.back() *= 3;
      const auto expected = brute_own(s, two, each);
      require_same(ask(host{1}, model, s.poses, two, self_filter{.padding = each}), expected, v, what + ", one a part");
      require_same(prepared(s.poses, two, {.padding = each}), expected, v, what + ", prepared");
      const auto both = min_distance_filtered(host{}, model, s.poses, two, {.padding = each});
      require_same(both.filter, expected, v, what + ", with the rest");
      require_rest(both, ask(host{}, model, s.poses, without(two, expected, kept), min_distance{}), v, what);
      own += all.counts.own, uncertain += all.counts.uncertain;
    }
  }
  CHECK((own > 1000 && uncertain > 0));
}

const std::vector<inner_sphere> one_ball{{{0, 0, 0}, 1}};
const std::vector poses{Eigen::Isometry3d::Identity()};

}  // namespace

TEST_CASE("Points of a robot of spheres are hidden, and the rest is asked about") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("Points of a robot of triangles are hidden, and the rest is asked about") {
  all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("What gap and tolerance leave open is uncertain, and not hidden") {
  const std::vector<vec3> points{
      {1.2f, 0, 0}, {1.45f, 0, 0}, {1.53f, 0, 0}, {3, 0, 0}, {clearance::not_a_number, 0, 0}};
  const auto ask = [&](double gap, double tolerance) {
    const clearance::model robot{
        std::vector{clearance::make_part(clearance::build<clearance::sphere>(one_ball), gap, tolerance)}};
    return clearance::ask(host{}, robot, poses, point_span(points), self_filter{.padding = {0.5}});
  };
  using enum point_label;
  CHECK(ask(0, 0).labels == std::vector{own, own, rest, rest, no_point});
  CHECK(ask(0.1, 0).labels ==
        std::vector{own, own, uncertain, rest, no_point});  // the solid may be nearer by the gap, and not farther
  CHECK(ask(0.01, 0.1).labels == std::vector{own, uncertain, uncertain, rest, no_point});
  const auto open = ask(clearance::infinity, 0);  // without a certificate
  CHECK(open.labels == std::vector{own, own, uncertain, uncertain, no_point});
  CHECK((open.counts.own == 2 && open.counts.uncertain == 2 && open.counts.points.valid == 4 &&
         open.rest == std::vector<std::uint32_t>{2, 3}));
}

TEST_CASE("An arm before a camera is hidden from a robot that is another one") {
  const clearance::model arm{std::vector{clearance::make_part(clearance::build<clearance::sphere>(one_ball))}};
  const clearance::model base{std::vector{clearance::make_part(
      clearance::build<clearance::aabb>(std::vector<inner_sphere>{{{0, 5, 0}, 1}, {{0, 7, 0}, 1}}))}};
  const std::vector<vec3> points{{0, 1.005f, 0}, {0, 2, 0}, {9, 9, 9}};
  const auto r = min_distance_filtered(host{}, base, poses, arm, poses,
                                       std::tuple(point_span(points), placed{point_span(points), shifted(0, -0.5, 0)}));
  CHECK((r.filter.rest == std::vector<std::uint32_t>{1, 2, 4, 5} &&
         r.filter.offsets == std::vector<std::size_t>{0, 3, 6}));
  CHECK((r.rest.point == 1 && r.rest.distance == 2 && r.rest.dropped[int(clearance::drop_reason::masked)] == 2));
}

TEST_CASE("All are the robot's, no points, and what cannot be asked") {
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(one_ball))}};
  const std::vector<vec3> points{{1, 0, 0}, {0, 0.5f, 0}};
  const auto all = min_distance_filtered(host{}, robot, poses, points);
  CHECK((all.filter.rest.empty() && all.filter.counts.own == 2 && all.rest.state == clearance::state::no_data));
  const auto none = min_distance_filtered(host{}, robot, poses, std::vector<placed<point_span>>{});
  CHECK((none.filter.labels.empty() && none.filter.offsets == std::vector<std::size_t>{0} &&
         none.rest.state == clearance::state::no_data));
  for (const double bad : {-0.01, double(clearance::not_a_number), double(clearance::infinity)})
    CHECK_THROWS_AS(ask(host{}, robot, poses, points, self_filter{.padding = {bad}}), std::invalid_argument);
  CHECK_THROWS_AS(ask(host{}, robot, poses, points, self_filter{.padding = {0, 0}}), std::invalid_argument);
  CHECK_THROWS_AS(ask(host{}, robot, poses, points, self_filter{.padding = {}}), std::invalid_argument);
}

TEST_CASE("A masked source reads four at once what it reads one by one, and tells what is hidden") {
  verdict v;
  dice d(31);
  std::vector<vec3> points = d.points(1024, 1);
  std::vector<point_label> labels;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool shown = i >= 512 && i < 700;
    labels.push_back(point_label(shown ? 0 : d.below(3)));
    if (i % 5 == 0)
      points[i].z = clearance::infinity, labels.back() = !shown && i % 2 ? point_label::own : point_label::no_point;
  }
  const clearance::masked hidden(point_span(points), labels.data());
  static_assert(clearance::fetched_source<decltype(hidden)> && clearance::surveyed_source<decltype(hidden)>);
  const auto look = [&](std::size_t i) {
    vec3 at[4];
    const unsigned reasons = hidden.look(hidden.fetch(hidden.skip(hidden.seek(0), i)), i, at);
    for (unsigned j = 0; j < 4; ++j) {
      const clearance::sample s = hidden[i + j];
      v.require((reasons >> 8 * j & 0xff) == unsigned(s.dropped), "point ", i + j, " is ", reasons >> 8 * j & 0xff,
                " and not ", int(s.dropped));
      v.require(same_bytes(at[j], points[i + j]), "point ", i + j, " is elsewhere");
    }
  };
  std::size_t surveyed = 0;
  for (std::size_t i = 0; i < points.size(); i += 4) look(i);
  for (std::size_t i = 0; i < points.size(); i += clearance::surveyed_points) {
    clearance::extent box;
    std::uint32_t dropped[clearance::drop_reasons] = {}, expected[clearance::drop_reasons] = {};
    if (!hidden.survey(i, box, dropped)) continue;
    ++surveyed;
    for (std::size_t j = 0; j < clearance::surveyed_points; ++j)
      if (const auto s = hidden[i + j]; !s.valid()) ++expected[int(s.dropped)];
    v.require(std::ranges::equal(dropped, expected), "the tile from ", i, " on");
  }
  CHECK(surveyed == 1);  // one of eight has nothing hidden
}

TEST_CASE("A mask over clouds of every kind numbers them as a call does") {
  const std::vector<vec3> a{{0, 0, 0}, {1, 0, 0}}, b{{2, 0, 0}};
  const std::vector<point_label> labels{point_label::own, point_label::rest, point_label::own};
  const auto hidden = [&](const auto& clouds) {
    std::vector<int> reasons;
    const auto behind = clearance::masked_clouds(clouds, labels.data());
    clearance::for_each_cloud(behind, [&](const auto& source, const Eigen::Isometry3d&) {
      for (std::size_t i = 0; i < source.size(); ++i) reasons.push_back(int(source[i].dropped));
    });
    return reasons;
  };
  constexpr int masked = int(clearance::drop_reason::masked);
  using one_of = std::variant<point_span, placed<point_span>>;
  CHECK(hidden(a) == std::vector{masked, 0});
  CHECK(hidden(std::vector{point_span(a), point_span(b)}) == std::vector{masked, 0, masked});
  CHECK(hidden(std::tuple(a, placed{point_span(b)})) == std::vector{masked, 0, masked});
  CHECK(hidden(std::vector<one_of>{point_span(a), placed{point_span(b)}}) == std::vector{masked, 0, masked});
  CHECK(hidden(std::variant<std::vector<vec3>, point_span>(a)) == std::vector{masked, 0});
  CHECK(hidden(std::variant<std::vector<vec3>, point_span>(point_span(a))) == std::vector{masked, 0});
}

TEST_CASE("A robot that holds something is as if it had always been of more parts") {
  verdict v;
  dice d(32);
  scene<inner_sphere> s;
  for (int part = 0; part < 3; ++part)
    s.parts.push_back(random_spheres(d, 40, 0.2, 0.1)), s.poses.push_back(d.pose(0.5));
  s.points = d.points(3000, 1);
  const auto whole = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clearance::model arm{std::vector{whole.parts()[0], whole.parts()[1]}}, tool{std::vector{whole.parts()[2]}};
  const auto both = attach(host{}, arm, tool);
  require_same(ask(host{}, both, s.poses, point_span(s.points), self_filter{}),
               ask(host{}, whole, s.poses, point_span(s.points), self_filter{}), v, "attached");
  const auto a = ask(host{}, both, s.poses, point_span(s.points), min_distance{}),
             b = ask(host{}, whole, s.poses, point_span(s.points), min_distance{});
  CHECK((same_bits(a.distance, b.distance) && same_bits(a.lower, b.lower) && a.part == b.part && a.point == b.point &&
         a.primitive == b.primitive));
  CHECK(attach(host{}, both, tool).size() == 4);
}

}  // namespace self_filter_test
