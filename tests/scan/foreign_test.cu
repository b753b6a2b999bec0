// SPDX-License-Identifier: BSD-3-Clause
// Foreign trees in the kernel of a scan: linked, flat, deeper and wider than its stacks. They give the answer of brute
// force and of the host, in every bit, and so do more parts than a kernel takes.
#include "support/brute_distances.hpp"
#include "support/linked_tree.hpp"
#include "support/product_device.cuh"
#include "support/wide_tree.hpp"

#include <clearance/bvh/any_tree.hpp>
#include <clearance/bvh/flat_list.hpp>
#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace foreign_test {

using namespace testing;
using clearance::device, clearance::host, clearance::min_distance, clearance::placed, clearance::point_span;

namespace {

/// One call and a prepared query, cold and warm, with a bound for all and one a part, as the host says it.
template <class Here, class There, class Cloud>
void ask(const Here& on_host, const There& model, const std::vector<Eigen::Isometry3d>& poses, const Cloud& cloud,
         verdict& v, const std::string& what) {
  const device gpu;
  const auto expected = ask(host{}, on_host, poses, cloud, min_distance{});
  const auto [robot, each] = clearance::ask(host{}, on_host, poses, cloud, clearance::min_distance_per_part{});
  v.require(same_result(ask(gpu, model, poses, cloud, min_distance{}), expected), what,
            ", one call: differs from the host's result");
  const auto [by_parts, own] = clearance::ask(gpu, model, poses, cloud, clearance::min_distance_per_part{});
  v.require(same_result(by_parts, robot) && std::ranges::equal(own, each, same_minimum), what,
            ", one call, per part: differs");
  for (const real d_max : {real(0.3), clearance::infinity})
    require_same(clearance::ask(gpu, model, poses, cloud, clearance::distances{d_max, true}),
                 clearance::ask(host{}, on_host, poses, cloud, clearance::distances{d_max, true}), v,
                 what + ", distances");
  clearance::query query(gpu, model, clearance::min_distance{});
  clearance::query per_part(gpu, model, clearance::min_distance_per_part{});
  for (const char* when : {", cold", ", warm"}) {
    v.require(same_result(query(poses, cloud), expected), what + when, ": differs from the host's result");
    const auto& found = per_part(poses, cloud);
    v.require(same_result(found.all, robot), what + when, ": differs from the host's result by parts");
    v.require(std::ranges::equal(found.parts, each, same_minimum), what + when, ": some part's minimum differs");
  }
}

/// A linked tree over the primitives of every part of a scene, here and there.
template <class V, class P>
void ask_linked(const scene<P>& s, bool lopsided, verdict& v, const std::string& what) {
  const device gpu;
  using view = clearance::part_view<linked_view<V, P>>;
  std::vector<linked_tree<V, P>> trees;
  std::vector<device::buffer<linked_node<V, P>>> nodes;
  std::vector<view> here, there;
  std::vector<clearance::part_facts> facts;
  std::uint32_t depth = 0;
  for (const auto& primitives : s.parts) trees.emplace_back(primitives, lopsided);
  for (std::size_t k = 0; k < trees.size(); ++k) {
    const ball around = clearance::enclosing_ball(std::span<const P>(s.parts[k]));
    facts.push_back({around.center, around.radius, 0, 0});
    const auto tree = trees[k].view();
    depth = std::max(depth, tree.depth());
    here.push_back({tree, {}, facts[k]});
    nodes.push_back(gpu.copy_in(std::span<const linked_node<V, P>>(trees[k].placed_at(nullptr))));
    const auto moved = trees[k].placed_at(nodes[k].data());
    gpu.stage(std::span<const linked_node<V, P>>(moved), nodes[k].data());
    there.push_back({{nodes[k].data(), tree.depth()}, {}, facts[k]});
  }
  const auto parts = gpu.copy_in(std::span<const view>(there));
  const placed cloud{point_span(s.points), s.cloud_pose};
  const clearance::model_view<view> on_host{here.data(), facts, depth, 2}, model{parts.data(), facts, depth, 2};
  require_equal(ask(gpu, model, s.poses, cloud, min_distance{}),
                brute_force(brute_parts(s), s.poses, {brute_cloud(cloud.source, cloud.pose)}), v, what);
  ask(on_host, model, s.poses, cloud, v, what);
}

}  // namespace

TEST_CASE("A linked binary tree goes through the kernel") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) ask_linked<clearance::sphere>(s, false, v, s.name);
  for (const auto& s : scenes<triangle>()) ask_linked<clearance::aabb>(s, false, v, s.name);
}

TEST_CASE("A tree deeper than the stacks of the kernel is walked with memory", "[slow]") {
  verdict v;
  scene<inner_sphere> s;
  dice d(31);
  for (int part = 0; part < 2; ++part) {
    s.parts.emplace_back();
    for (int k = 0; k < 400; ++k) s.parts.back().push_back({d.point(1), 0.01f + d.number(0, 0.02)});
    s.poses.push_back(d.pose(0.5));
  }
  s.cloud_pose = d.pose(0.1);
  for (const real far : {2, 30}) {  // from 30 m much is nearly equally far
    s.points = d.points(5000, far);
    ask_linked<clearance::sphere>(s, true, v, "deep, " + std::to_string(far));
  }
}

TEST_CASE("A tree wider than eight, and a flat list, are walked eight children at a time") {
  const device gpu;
  verdict v;
  dice d(32);
  for (const std::uint32_t count : {9u, 100u, 1500u}) {
    std::vector<inner_sphere> balls;
    for (std::uint32_t k = 0; k < count; ++k) balls.push_back({d.point(1), 0.01f + d.number(0, 0.02)});
    const std::vector<Eigen::Isometry3d> poses = {d.pose(0.5)};
    const std::vector<vec3> points = d.points(3000, 2);
    const placed cloud{point_span(points), d.pose(0.1)};
    const ball around = clearance::enclosing_ball(std::span<const inner_sphere>(balls));
    const clearance::part_facts facts{around.center, around.radius, 0, 0};
    const auto volumes = wide_volumes<clearance::sphere>(balls);
    const auto balls_there = gpu.copy_in(std::span<const inner_sphere>(balls));
    const auto volumes_there = gpu.copy_in(std::span<const clearance::sphere>(volumes));
    const auto compare = [&](const auto& tree, const auto& tree_there, const std::string& what) {
      using view = clearance::part_view<std::remove_cvref_t<decltype(tree)>>;
      const view here{tree, {}, facts}, there{tree_there, {}, facts};
      const auto part = gpu.copy_in(std::span<const view>(&there, 1));
      ask(clearance::model_view<view>{&here, {&facts, 1}, tree.depth(), tree.width()},
          clearance::model_view<view>{part.data(), {&facts, 1}, tree.depth(), tree.width()}, poses, cloud, v,
          what + ", " + std::to_string(count));
    };
    compare(wide_view<clearance::sphere, inner_sphere>{volumes.data(), balls.data(), count},
            wide_view<clearance::sphere, inner_sphere>{volumes_there.data(), balls_there.data(), count}, "wide");
    compare(clearance::flat_list<clearance::sphere, inner_sphere>{volumes[0], balls.data(), count},
            clearance::flat_list<clearance::sphere, inner_sphere>{volumes[0], balls_there.data(), count}, "flat");
    // And arrays, which ask for it: they would be read in another way.
    clearance::bvh<clearance::sphere, inner_sphere> tree;
    tree.volumes = volumes, tree.primitives = balls, tree.depth = 1, tree.width = count;
    tree.nodes.push_back({1, count});
    for (std::uint32_t k = 0; k < count; ++k)
      tree.nodes.push_back({k, 1 | clearance::bvh_node::leaf_bit}), tree.ids.push_back(k);
    const auto tree_there = tree.on(gpu);
    compare(clearance::any_tree{tree.view()}, clearance::any_tree{tree_there.view()}, "arrays");
    const clearance::model on_host(std::vector{clearance::make_part(std::move(tree))});
    const auto model = on_host.on(gpu);
    CHECK_THROWS_AS(ask(gpu, model, poses, cloud, min_distance{}), std::invalid_argument);
  }
}

namespace {

/// A tree of a wide root and, below it, `groups` nodes of `width` leaves each.
clearance::bvh<clearance::sphere, inner_sphere> wide_below_wide(dice& d, std::uint32_t groups, std::uint32_t width) {
  const auto volume = [](std::span<const ball> balls) {
    return clearance::bounding_volume_traits<clearance::sphere>::fit(balls);
  };
  clearance::bvh<clearance::sphere, inner_sphere> tree;
  auto& all = tree.primitives;
  std::vector<ball> balls;
  for (std::uint32_t group = 0; group < groups; ++group) {
    const vec3 about = d.point(1);
    for (std::uint32_t k = 0; k < width; ++k)
      all.push_back({about + d.point(0.2), 0.01f + d.number(0, 0.02)}), balls.push_back(all.back().balls()[0]);
  }
  tree.depth = 2, tree.width = std::max(groups, width);
  tree.nodes.push_back({1, groups}), tree.volumes.push_back(volume(balls));
  for (std::uint32_t group = 0; group < groups; ++group) {
    tree.nodes.push_back({1 + groups + group * width, width});
    tree.volumes.push_back(volume(std::span(balls).subspan(group * width, width)));
  }
  for (std::uint32_t k = 0; k < all.size(); ++k) {
    tree.nodes.push_back({k, 1 | clearance::bvh_node::leaf_bit}), tree.ids.push_back(k);
    tree.volumes.push_back(volume(all[k].balls()));
  }
  return tree;
}

/// Some of them are a robot's parts.
void ask_wide(dice& d, int parts, std::uint32_t groups, std::uint32_t width, int often, verdict& v) {
  const device gpu;
  scene<inner_sphere> s;
  using tree_type = clearance::bvh<clearance::sphere, inner_sphere>;
  std::vector<tree_type> trees;
  std::vector<decltype(std::declval<tree_type>().on(gpu))> trees_there;
  using view = clearance::part_view<clearance::any_tree<decltype(trees[0].view())>>;
  std::vector<view> here, there;
  std::vector<clearance::part_facts> facts;
  for (int part = 0; part < parts; ++part) trees.push_back(wide_below_wide(d, groups, width));
  for (const tree_type& tree : trees) {
    const ball around = clearance::enclosing_ball(std::span<const inner_sphere>(tree.primitives));
    facts.push_back({around.center, around.radius, 0, 0});
    trees_there.push_back(tree.on(gpu));
    const clearance::any_tree on_host{tree.view()}, on_gpu{trees_there.back().view()};
    here.push_back({on_host, {}, facts.back()}), there.push_back({on_gpu, {}, facts.back()});
    s.parts.push_back(tree.primitives), s.poses.push_back(d.pose(0.5));
  }
  const auto views = gpu.copy_in(std::span<const view>(there));
  const std::uint32_t most = std::max(groups, width);
  const std::string what =
      std::to_string(parts) + " parts, " + std::to_string(width) + " below " + std::to_string(groups);
  for (const real far : {2, 30}) {  // from 30 m much is nearly equally far
    s.points = d.points(3000, far);
    for (int again = 0; again < often; ++again) {
      const placed cloud{point_span(s.points), d.pose(0.1)};
      const clearance::model_view<view> on_host{here.data(), facts, 2, most}, model{views.data(), facts, 2, most};
      if (again == 0)
        require_equal(ask(gpu, model, s.poses, cloud, min_distance{}),
                      brute_force(brute_parts(s), s.poses, {brute_cloud(cloud.source, cloud.pose)}), v, what);
      ask(on_host, model, s.poses, cloud, v, what);
    }
  }
  CHECK_THROWS_WITH(
      ask(gpu, clearance::model_view<view>{views.data(), facts, 2, 262'145}, s.poses, point_span{}, min_distance{}),
      "clearance: a node has 262145 children; a device takes 262144");
}

}  // namespace

TEST_CASE("Wide nodes below wide nodes lose no child, and what is too wide is refused") {
  verdict v;
  dice d(36);
  for (const std::uint32_t width : {9u, 20u, 70u}) ask_wide(d, 1, width, width, 5, v);
}

TEST_CASE("Of more than 512 children below a wide node every part's are its own") {
  verdict v;
  dice d(37);
  ask_wide(d, 3, 9, 600, 2, v);
}

TEST_CASE("A point inside a solid whose triangles hang on a deep tree is certainly inside") {
  const device gpu;
  verdict v;
  clearance::triangle_mesh m;
  const int around = 24;
  for (const double z : {-1.0, 1.0})
    for (int k = 0; k < around; ++k)
      m.vertices.emplace_back(std::cos(2 * M_PI * k / around), std::sin(2 * M_PI * k / around), z);
  const auto at = [&](int k, int ring) { return std::uint32_t(ring * around + (k + around) % around); };
  for (int k = 0; k < around; ++k)
    m.triangles.push_back({at(k, 0), at(k + 1, 0), at(k, 1)}),
        m.triangles.push_back({at(k, 1), at(k + 1, 0), at(k + 1, 1)});
  for (int k = 1; k + 1 < around; ++k)
    m.triangles.push_back({at(0, 0), at(k + 1, 0), at(k, 0)}),
        m.triangles.push_back({at(0, 1), at(k, 1), at(k + 1, 1)});
  const auto closed = clearance::close_mesh(m);
  const auto whole = clearance::make_part<clearance::aabb>(closed);
  std::vector<triangle> triangles(whole.tree.primitives.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) triangles[whole.tree.ids[k]] = whole.tree.primitives[k];
  const linked_tree<clearance::aabb, triangle> tree(triangles, true);
  auto nodes = gpu.copy_in(std::span<const linked_node<clearance::aabb, triangle>>(tree.placed_at(nullptr)));
  const auto moved = tree.placed_at(nodes.data());
  gpu.stage(std::span<const linked_node<clearance::aabb, triangle>>(moved), nodes.data());
  const auto interior_there = whole.interior.on(gpu);
  using view = clearance::part_view<linked_view<clearance::aabb, triangle>, decltype(whole.interior.view())>;
  const view here{tree.view(), whole.interior.view(), whole.facts},
      there{{nodes.data(), tree.view().depth()}, interior_there.view(), whole.facts};
  REQUIRE(clearance::stack_need(tree.view()) > 64);
  const auto part = gpu.copy_in(std::span<const view>(&there, 1));
  dice d(33);
  for (const real size : {real(0.5), real(3)}) {
    const std::vector<vec3> points = d.points(2000, size);
    ask(clearance::model_view<view>{&here, {&whole.facts, 1}, tree.view().depth(), 2},
        clearance::model_view<view>{part.data(), {&whole.facts, 1}, tree.view().depth(), 2},
        {Eigen::Isometry3d::Identity()}, point_span(points), v, "cylinder");
  }
}

TEST_CASE("More parts than a kernel takes are looked at in groups", "[slow]") {
  verdict v;
  dice d(34);
  for (const int parts : {129, 300}) {
    scene<inner_sphere> s;
    for (int part = 0; part < parts; ++part) {
      s.parts.emplace_back();
      for (int k = 0; k < 20; ++k) s.parts.back().push_back({d.point(0.1f), 0.005f + d.number(0, 0.01)});
      s.poses.push_back(d.pose(1));
    }
    const auto on_host = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto first = d.points(4000, 2), second = d.points(3000, 2);
    const auto pose = d.pose(0.1);
    const auto model = on_host.on(device{});
    ask(on_host, model, s.poses, placed{point_span(first), pose}, v, std::to_string(parts) + " parts");
    ask(on_host, model, s.poses, std::tuple(placed{point_span(first), pose}, point_span(second)), v,
        std::to_string(parts) + " parts, two clouds");
    s.poses[128] = s.poses[0], s.parts[128] = s.parts[0];  // a tie goes to the lower part, of another group
    ask(make_model<clearance::sphere>(s, {}, clearance::wrapped{}),
        make_model<clearance::sphere>(s, {}, clearance::wrapped{}).on(device{}), s.poses, point_span(first), v,
        std::to_string(parts) + " parts, tied");
  }
}

TEST_CASE("Parts of unequal tolerance are one robot, in groups too") {
  verdict v;
  const device gpu;
  std::vector<std::vector<inner_sphere>> bodies(130, {{{50, 50, 50}, 0.1f}});
  bodies[0] = {{{0, 0, 0}, 1}}, bodies[128] = {{{5, 0, 0}, 1}};
  const std::vector<Eigen::Isometry3d> poses(bodies.size(), Eigen::Isometry3d::Identity());
  const std::vector<vec3> points = {{0.4f, 0, 0},
                                    {5.5f, 0, 0}};  // deepest in the first part, and certainly inside the other alone
  for (const double tolerance : {0.0, 0.7}) {
    const auto on_host = clearance::make_model<clearance::sphere>(
        bodies,
        [&](std::size_t k) -> clearance::part_options { return {.build = {}, .tolerance = k == 0 ? tolerance : 0}; });
    const auto expected = ask(host{}, on_host, poses, point_span(points), min_distance{});
    v.require(expected.part == 0 &&
                  expected.state == (tolerance > 0 ? clearance::state::possible : clearance::state::collision),
              "the scene is not what it was meant to be");
    ask(on_host, on_host.on(gpu), poses, point_span(points), v, "tolerance " + std::to_string(tolerance));
  }
}

}  // namespace foreign_test
