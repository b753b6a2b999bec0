// SPDX-License-Identifier: BSD-3-Clause
// Groups that walk by tangents on the host find the least over all primitives of all parts, in every bit: near and far,
// few and many, inside and outside.
#include "scan/tangent_scenes.hpp"

namespace tangents_test {

/// A volume of one's own that is not trivially copyable, though it copies as bytes.
struct own_box {
  clearance::aabb box;

  own_box() = default;
  explicit own_box(const clearance::aabb& b) : box(b) {}
  own_box(const own_box& other) : box(other.box) {}
  own_box& operator=(const own_box& other) {
    box = other.box;
    return *this;
  }
};

}  // namespace tangents_test

template <>
struct clearance::bounding_volume_traits<tangents_test::own_box> {
  using own_box = tangents_test::own_box;
  static constexpr bool bitwise_copyable = true;

  static own_box fit(std::span<const ball> balls) { return own_box(aabb::fit(balls)); }
  static real lower_bound(const own_box& v, vec3 q) { return v.box.lower_bound(q); }
  static tangent tangent_at(const own_box& v, vec3 q) { return v.box.tangent_at(q); }
};

namespace tangents_test {

using namespace testing;
using clearance::distances, clearance::host, clearance::placed, clearance::point_span;

namespace {

const auto check = [](const auto& s, const auto& model, const std::vector<vec3>& points, const std::string& what,
                      const auto& inside) {
  using view = std::remove_cvref_t<decltype(*model.view().parts)>;
  static_assert(clearance::scan::tangent_hierarchy<typename view::hierarchy_type>, "it walks otherwise");
  verdict v;
  const placed cloud{point_span(points), s.cloud_pose};
  for (const real d_max : {clearance::infinity, real(0.3), real(0), real(-0.01)}) {
    const auto expected = brute_distances(s, cloud.source, cloud.pose, d_max, inside);
    clearance::query warm(host{2}, model, distances{d_max, true});
    for (const unsigned threads : {1u, 2u})
      require_same(ask(host{threads}, model, s.poses, cloud, distances{d_max, true}), expected, v,
                   what + " within " + std::to_string(d_max) + ", threads " + std::to_string(threads));
    for (int frame = 0; frame < 2; ++frame) require_same(warm(s.poses, cloud), expected, v, what + ", warm");
  }
};

/// A solid whose primitives are signed.
struct big_ball {
  real radius;
  bool inside(vec3 q) const { return clearance::length(q) < radius; }
};

}  // namespace

TEST_CASE("By tangents to inner spheres, in every volume, on the host") { by_tangents_to_spheres(check); }
TEST_CASE("By tangents to triangles, in every volume, on the host") { by_tangents_to_triangles(check); }
TEST_CASE("By tangents in a volume of one's own") { by_tangents_in_all_scenes<own_box, inner_sphere>(8, 3, check); }

TEST_CASE("By tangents to solids that overlap and repeat, from inside, on their faces and in their middles") {
  by_tangents_to_solids(check);
}

TEST_CASE("A point inside a solid is 0 away, whatever signed primitives of that solid are nearer") {
  dice d(43);
  scene<inner_sphere> s{"signed", {}, {}, {}};
  std::vector<clearance::part<clearance::bvh<clearance::sphere, inner_sphere>, big_ball>> parts;
  for (int k = 0; k < 3; ++k) {
    s.parts.push_back(random_spheres(d, 60, 0.5, 0.2));
    const auto part = clearance::make_part(clearance::build<clearance::sphere>(s.parts.back()));
    parts.push_back({part.tree, big_ball{k == 1 ? 0.1f : 0.4f}, part.facts});
    s.poses.push_back(d.pose(0.3));
  }
  // The middle of a large ball is a metre deep, but 0 away; a small ball there decides.
  for (const inner_sphere& b : {inner_sphere{{0, 0, 0}, 1}, inner_sphere{{0.05f, 0, 0}, 0.1f}}) {
    s.parts.push_back({b});
    const auto part = clearance::make_part(clearance::build<clearance::sphere>(s.parts.back()));
    parts.push_back({part.tree, big_ball{b.radius == 1 ? 0.4f : 0}, part.facts});
    s.poses.push_back(shifted(9, 0, 0));
  }
  const clearance::model model(parts);
  auto points = patches(d, 1);
  for (int k = 0; k < 64; ++k) points.push_back(d.point(0.01, {9, 0, 0}));
  check(s, model, points, s.name, [&](std::uint32_t k, vec3 q) { return parts[k].interior.inside(q); });
}

TEST_CASE("By tangents from few points, and from all numbers of points up to two groups") {
  dice d(44);
  const auto s = scenes<triangle>()[0];
  const auto model = make_model<clearance::aabb>(s, {}, clearance::wrapped{});
  const vec3 corner = d.point(1);
  std::vector<vec3> points;
  for (int k = 0; k < 130; ++k) points.push_back(corner + d.point(0.01));
  for (std::size_t count = 0; count <= points.size(); count += count < 70 ? 1 : 7)
    check(s, model, {points.begin(), points.begin() + std::ptrdiff_t(count)}, std::to_string(count) + " points",
          nothing_inside);
}

TEST_CASE("By tangents to 200 parts") { by_tangents_to_many_parts(check); }

TEST_CASE("By tangents through a node of more children than are looked at together") {
  dice d(46);
  const scene<inner_sphere> s{"wide", {random_spheres(d, 30)}, {d.pose(0.3)}, {}};
  const auto tree = clearance::build<clearance::sphere>(s.parts[0], {.leaf_size = 1});
  auto wide = tree;
  wide.nodes.resize(1), wide.volumes.resize(1);
  for (std::size_t n = 1; n < tree.nodes.size(); ++n)
    if (tree.nodes[n].is_leaf()) wide.nodes.push_back(tree.nodes[n]), wide.volumes.push_back(tree.volumes[n]);
  wide.width = std::uint32_t(wide.nodes.size() - 1);
  wide.nodes[0] = {1, wide.width};
  REQUIRE(wide.width == 30);
  const clearance::model model{std::vector{clearance::make_part(wide)}};
  check(s, model, patches(d, 1.5), "30 children", nothing_inside);
}

TEST_CASE("By tangents from a wall in rows and in a picture") {
  verdict v;
  dice d(45);
  scene<triangle> s{
      "wall", {random_triangles(d, 300, 0.5), random_triangles(d, 40, 0.3, 0.4)}, {d.pose(0.2), d.pose(1)}, {}};
  s.cloud_pose = shifted(-1.5, 0, 0);
  const auto model = make_model<clearance::aabb>(s, {}, clearance::wrapped{});
  std::vector<float> depth;
  for (int i = 0; i < 160 * 240; ++i) depth.push_back(i % 97 == 0 ? 0 : 1.4f + (i / 20 % 2 == 0 ? 0.2f : 0));
  const clearance::depth_image image(depth.data(), 240, 160, clearance::intrinsics{200, 200, 120, 80});
  require_same(ask(host{}, model, s.poses, placed{image, s.cloud_pose}, distances{clearance::infinity, true}),
               brute_distances(s, image, s.cloud_pose, clearance::infinity, nothing_inside), v, "a picture");
}

}  // namespace tangents_test
