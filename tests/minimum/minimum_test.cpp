// SPDX-License-Identifier: BSD-3-Clause
// What the minimum over all parts and points promises besides its bits: truth, witness, several clouds, any tree,
// inside.
#include "support/linked_tree.hpp"
#include "support/product.hpp"
#include "support/volumes.hpp"

#include <clearance/bvh/flat_list.hpp>
#include <clearance/make_model.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace minimum_test {

using namespace testing;
using clearance::host, clearance::min_distance, clearance::min_distance_per_part, clearance::placed,
    clearance::point_span;

namespace {

wide exact(const inner_sphere& s, oracle::vec q) { return oracle::to_sphere(q, wider(s.center), s.radius); }
wide exact(const triangle& t, oracle::vec q) { return oracle::to_triangle(q, wider(t.a), wider(t.b), wider(t.c)); }
Eigen::Isometry3d identity() { return Eigen::Isometry3d::Identity(); }

/// The distance, its bracket and its witness against long double all the way from the input.
template <class V, class P>
void check_truth() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    if (s.name == "many points" || s.points.size() < 33) continue;
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto r = ask(host{}, model, s.poses, placed{point_span(s.points), s.cloud_pose}, min_distance{});
    wide truth = infinity, scale = 0;
    for (const vec3 p : s.points) {
      if (!clearance::is_finite(p)) continue;
      const auto world = oracle::moved(s.cloud_pose.matrix(), wider(p));
      for (std::size_t k = 0; k < s.parts.size(); ++k)
        for (const P& primitive : s.parts[k]) {
          const wide d = exact(primitive, oracle::moved_back(s.poses[k].matrix(), world));
          if (d < truth) truth = d;
        }
    }
    const auto& part = model.parts()[r.part];
    const auto t = s.poses[r.part].translation();
    // |p| and |t| as they are once the coordinates' origin is near the robot.
    const wide near = s.name == "far from the origin" ? 64 : t.norm() + 2;
    scale = std::abs(truth) + near + oracle::length(wider(part.facts.center)) + part.facts.radius;
    v.require(std::abs(r.distance - truth) <= 8 * 0x1p-24L * 2 * scale, s.name, ": distance", r.distance, " instead of",
              truth);
    const wide to_solid = std::max(truth, wide(0));
    v.require(r.lower <= to_solid && to_solid <= r.upper, s.name, ": bracket", r.lower, " to", r.upper, " misses",
              to_solid);
    v.require(r.upper - std::max(r.lower, real(0)) <= 1e-3 * std::max(wide(1), scale / 100), s.name,
              ": the bracket is wide:", r.lower, r.upper);
    // The witness, in world coordinates.
    const auto at = oracle::moved(s.cloud_pose.matrix(), wider(s.points[r.point])), nearest = wider(r.nearest);
    const wide coordinates = oracle::length(at);
    v.require(oracle::between(wider(r.at), at) <= 1e-12L * (1 + coordinates), s.name, ": the point is elsewhere");
    v.require(std::abs(oracle::between(at, nearest) - std::abs(truth)) <= 32 * 0x1p-24L * scale, s.name, ": nearest is",
              oracle::between(at, nearest), " away");
    v.require(std::abs(exact(s.parts[r.part][r.primitive], oracle::moved_back(s.poses[r.part].matrix(), nearest))) <=
                  32 * 0x1p-24L * scale,
              s.name, ": nearest is not on the primitive");
    if (truth > 1e-3L * scale) {  // at a centre there is no direction
      const auto along = (1 / truth) * (at - nearest);
      v.require(oracle::between(wider(r.normal), along) <= 1e-3L, s.name, ": the normal points elsewhere");
    }
  }
}

template <class Words>
std::string refusal(Words call) {
  try {
    call();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

/// Can this be asked?
template <class... Given>
concept asks = requires(const Given&... given) { ask(host{}, given..., min_distance{}); };

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

}  // namespace

TEST_CASE("Spheres so small that squares of their distances vanish are found") {
  dice d(514);
  verdict v;
  for (const double size : {1e-24, 1e-23, 1e-22, 1e-20, 1e-18}) {
    std::vector<inner_sphere> all;
    for (int k = 0; k < 3000; ++k)
      all.push_back({clearance::scaled(real(size), d.point(1)), real(size * d.number(0.001, 0.01))});
    const std::vector<vec3> points{{0, 0, 0}, clearance::scaled(real(size), d.point(1))};
    real least = infinity;
    for (const vec3 p : points)
      for (const inner_sphere& s : all) least = std::min(least, s.distance(p));
    const auto ask = [&](auto volume) {
      const clearance::model robot{std::vector{clearance::make_part(clearance::build<decltype(volume)>(all))}};
      return clearance::ask(host{}, robot, std::vector{identity()}, point_span(points), min_distance{}).distance;
    };
    v.require(ask(clearance::sphere{}) == least && ask(clearance::aabb{}) == least && ask(clearance::obb{}) == least,
              "of size ", size, ": not ", least);
  }
}

TEST_CASE("The distance to inner spheres is the oracle's, and so are bracket and witness") {
  check_truth<clearance::sphere, inner_sphere>();
}
TEST_CASE("The distance to triangles is the oracle's, and so are bracket and witness") {
  check_truth<clearance::obb, triangle>();
}

TEST_CASE("Clouds of different kinds share one search; ties go to the lowest cloud, then point, part, primitive") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto parts = brute_parts(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    for (const bool images_first : {false, true}) {
      clearance::min_distance_result r;
      std::vector<clearance::part_minimum> minima(model.size());
      const placed raw{all.raw, all.camera_pose};
      const placed metres{all.metres, all.camera_pose};
      const auto points = std::tuple(placed{all.floats, s.cloud_pose}, placed{all.span, s.cloud_pose},
                                     placed{all.doubles, s.cloud_pose});
      const auto ask = [&](const auto& given) {
        std::vector<brute_cloud> clouds;
        clearance::for_each_cloud(
            given, [&](const auto& source, const Eigen::Isometry3d& pose) { clouds.emplace_back(source, pose); });
        const auto expected = brute_force(parts, s.poses, clouds);
        enqueue(host{}, model, s.poses, given, min_distance_per_part{}, {&r, minima.data()});
        require_equal(r, expected, v, s.name);
        require_equal(minima, expected, v, s.name);
        require_equal(
            clearance::ask(clearance::plain{host{}, clearance::stack{}}, model, s.poses, given, min_distance{}),
            expected, v, s.name + ", plain");
      };
      if (images_first)
        ask(std::tuple(raw, metres, points));  // the second and third are the same points
      else
        ask(std::tuple(points, raw));
    }
    std::vector<placed<point_span>> several = {
        {all.span, s.cloud_pose}, {all.span, all.camera_pose}, {all.span, s.cloud_pose}};
    std::vector<brute_cloud> clouds;
    for (const auto& c : several) clouds.emplace_back(c.source, c.pose);
    require_equal(ask(host{}, model, s.poses, several, min_distance{}), brute_force(parts, s.poses, clouds), v,
                  s.name + ", several");
    v.require(ask(host{}, model, s.poses, std::vector<placed<point_span>>{}, min_distance{}).state ==
                  clearance::state::no_data,
              "no cloud");
  }
}

TEST_CASE("A source with its pose beside it is asked as the placed one is, by every form of the call") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto parts = brute_parts(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto check = [&](const auto& source, const Eigen::Isometry3d& pose) {
      const auto expected = brute_force(parts, s.poses, {brute_cloud(source, pose)});
      require_equal(ask(host{}, model, s.poses, source, pose, min_distance{}), expected, v, s.name);
      require_equal(ask(clearance::plain{host{}, clearance::stack{}}, model, s.poses, source, pose, min_distance{}),
                    expected, v, s.name + ", stack");
      const auto [r, each] =
          ask(clearance::plain{host{}, clearance::recursive{}}, model, s.poses, source, pose, min_distance_per_part{});
      require_equal(r, expected, v, s.name + ", per part");
      require_equal(each, expected, v, s.name + ", per part");
      clearance::min_distance_result later;
      enqueue(host{}, model, s.poses, placed{source, pose}, min_distance{}, &later);
      require_equal(later, expected, v, s.name + ", enqueued");
      std::vector<clearance::part_minimum> minima(model.size());
      enqueue(host{}, model, s.poses, placed{source, pose}, min_distance_per_part{}, {&later, minima.data()});
      require_equal(later, expected, v, s.name + ", enqueued");
      require_equal(minima, expected, v, s.name + ", enqueued");
      require_equal(ask(host{}, model.parts()[0], s.poses[0], source, pose, min_distance{}),
                    brute_force(std::vector{parts[0]}, {s.poses[0]}, {brute_cloud(source, pose)}), v,
                    s.name + ", one part");
    };
    check(all.span, s.cloud_pose);
    check(all.raw, all.camera_pose);
  }
}

TEST_CASE("A robot and its clouds may be given so; what may not is a sentence, in tests/compile") {
  using part = clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>;
  using model = clearance::model<part>;
  using poses = std::vector<Eigen::Isometry3d>;
  STATIC_REQUIRE(asks<model, poses, std::vector<vec3>>);
  STATIC_REQUIRE(asks<part, Eigen::Isometry3d, std::vector<vec3>>);
  STATIC_REQUIRE(asks<model, poses, point_span, Eigen::Isometry3d>);  // the cloud's pose
  STATIC_REQUIRE_FALSE((clearance::robot<int> || clearance::rigid_part<int>));
}

TEST_CASE("Volumes that the library does not know give the same bits") {
  verdict v;
  for (const auto& s : scenes<triangle>()) {
    const sources<triangle> all(s);
    const auto each = [&](auto use) { use(all.span, s.cloud_pose, "span"); };
    check_trees<kdop14>(s, each, clearance::wrapped{}, "k-DOP", v);
    check_trees<Eigen::AlignedBox3f>(s, each, clearance::wrapped{}, "foreign box", v);
  }
}

TEST_CASE("A pointer-linked tree and a flat list of somebody else give the same bits") {
  verdict v;
  using P = inner_sphere;
  using linked = clearance::part_view<linked_view<clearance::sphere, P>>;
  using list = clearance::part_view<clearance::flat_list<clearance::sphere, P>>;
  for (const auto& s : scenes<P>()) {
    const auto parts = brute_parts(s);
    std::vector<linked_tree<clearance::sphere, P>> trees;
    std::vector<linked> linked_parts;
    std::vector<list> lists;
    std::vector<clearance::part_facts> facts;
    std::uint32_t depth = 0;
    trees.reserve(s.parts.size());
    for (std::size_t k = 0; k < s.parts.size(); ++k) {
      facts.push_back(parts[k].facts);
      const auto view = trees.emplace_back(s.parts[k]).view();
      depth = std::max(depth, view.depth());
      linked_parts.push_back({view, {}, facts[k]});
      lists.push_back({{view.top->bounds, s.parts[k].data(), std::uint32_t(s.parts[k].size())}, {}, facts[k]});
    }
    const auto expected = brute_force(parts, s.poses, {brute_cloud(point_span(s.points), s.cloud_pose)});
    const placed cloud{point_span(s.points), s.cloud_pose};
    const clearance::model_view<linked> binary{linked_parts.data(), facts, depth, 2};
    const clearance::model_view<list> flat{lists.data(), facts, 0, 1};
    check_query(clearance::plain{host{}, clearance::recursive{}}, binary, s.poses, cloud, expected, v,
                s.name + ", linked");
    check_query(clearance::plain{host{}, clearance::stack{}}, binary, s.poses, cloud, expected, v, s.name + ", linked");
    check_query(host{}, binary, s.poses, cloud, expected, v, s.name + ", linked");
    check_query(host{}, flat, s.poses, cloud, expected, v, s.name + ", flat");
  }
}

TEST_CASE("A tree too deep for a stack is refused with its numbers, and the recursive traversal takes it") {
  std::vector<inner_sphere> line;
  for (int k = 0; k < 65; ++k) line.push_back({{real(k), 0, 0}, 0.25f});
  const linked_tree<clearance::sphere, inner_sphere> tree(line, true);
  clearance::part<linked_tree<clearance::sphere, inner_sphere>> deep{tree, {}, {{32, 0, 0}, 40, 0, 0}};
  const std::vector<vec3> points = {{40, 2, 0}, {64, 1, 0}};
  for (const std::string& words :
       {refusal(
            [&] { ask(clearance::plain{host{}, clearance::near_first{}}, deep, identity(), points, min_distance{}); }),
        refusal(
            [&] { ask(clearance::plain{host{}, clearance::stack{}}, deep, identity(), points, min_distance{}); })}) {
    CHECK(has(words, "depth 64"));
    CHECK(has(words, "65 entries"));
  }
  CHECK(ask(clearance::plain{host{}, clearance::recursive{}}, deep, identity(), points, min_distance{}).primitive ==
        64);
  CHECK(
      ask(clearance::plain{host{}, clearance::basic_stack<65>{}}, deep, identity(), points, min_distance{}).primitive ==
      64);
  CHECK(ask(clearance::plain{host{}, clearance::basic_near_first<65>{}}, deep, identity(), points, min_distance{})
            .distance == 0.75f);
}

TEST_CASE("The number of threads changes nothing") {
  for (const auto& s : scenes<triangle>()) {
    if (s.name != "many points" && s.name != "ties") continue;
    const auto model = make_model<clearance::obb>(s, {}, clearance::wrapped{});
    const auto first = ask(host{1}, model, s.poses, point_span(s.points), min_distance{});
    for (const unsigned threads : {0u, 2u, 3u, 0u, 2u}) {
      const auto r = ask(host{threads}, model, s.poses, point_span(s.points), min_distance{});
      CHECK(same_bits(r.distance, first.distance));
      CHECK((r.point == first.point && r.part == first.part && r.primitive == first.primitive));
      CHECK((same_bits(r.lower, first.lower) && same_bits(r.upper, first.upper) && r.valid == first.valid));
    }
  }
}

TEST_CASE("Poses that are not rigid, and a wrong number of them, are refused with a sentence") {
  const std::vector<inner_sphere> one = {{{0, 0, 0}, 1}};
  const auto model = clearance::make_model<clearance::sphere>(std::vector<std::vector<inner_sphere>>{one, one});
  const std::vector<vec3> points = {{3, 0, 0}};
  const auto ask = [&](std::vector<Eigen::Isometry3d> poses, Eigen::Isometry3d cloud = identity()) {
    return refusal([&] { clearance::ask(host{}, model, poses, placed{point_span(points), cloud}, min_distance{}); });
  };
  CHECK(ask({identity(), identity()}) == "");
  CHECK(has(ask({identity()}), "2 parts, but 1 poses"));
  CHECK(has(ask({}), "2 parts, but 0 poses"));
  CHECK(has(ask({identity(), identity(), identity()}), "2 parts, but 3 poses"));
  const auto with = [](auto change) {
    Eigen::Isometry3d pose = identity();
    change(pose.matrix());
    return pose;
  };
  using matrix = Eigen::Isometry3d::MatrixType;
  const std::vector<Eigen::Isometry3d> bad = {
      with([](matrix& m) { m(0, 0) = 1.001; }),        with([](matrix& m) { m.topLeftCorner<3, 3>() *= 2; }),
      with([](matrix& m) { m(0, 1) = 0.01; }),         with([](matrix& m) { m(2, 2) = -1; }),
      with([](matrix& m) { m(0, 3) = std::nan(""); }), with([](matrix& m) { m(1, 1) = std::nan(""); }),
      with([](matrix& m) { m(2, 3) = INFINITY; }),     with([](matrix& m) { m.setZero(); })};
  for (const auto& pose : bad) {
    CHECK(has(ask({identity(), pose}), "part 1 is not rigid"));
    CHECK(has(ask({identity(), identity()}, pose), "cloud 0 is not rigid"));
  }
  CHECK(has(ask({identity(), bad[3]}), "reflection"));
  // A rotation rounded to float is rigid.
  dice d(1);
  const Eigen::Isometry3d rounded =
      with([&](matrix& m) { m.topLeftCorner<3, 3>() = d.pose(0).linear().cast<float>().cast<double>(); });
  CHECK(ask({identity(), rounded}, rounded) == "");
  CHECK(has(refusal([] {
              clearance::model(std::vector<clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>>{});
            }),
            "no parts"));
}

TEST_CASE("A float cloud at 5e6 m is as good as its coordinates, and doubles keep their millimetres") {
  dice d(3);
  const auto primitives = random_spheres(d, 200, 1, 0.1);
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(primitives));
  const Eigen::Isometry3d pose = shifted(5e6, -4.5e6, 900) * d.pose(1);
  std::vector<double> records;
  for (int k = 0; k < 500; ++k)
    for (const double x : {5e6 + d.uniform(-3, 3), -4.5e6 + d.uniform(-3, 3), 900 + d.uniform(-3, 3)})
      records.push_back(x);
  clearance::strided_points<double> cloud;
  cloud.data = reinterpret_cast<const std::byte*>(records.data()), cloud.count = 500, cloud.step = 24;
  cloud.offset[1] = 8, cloud.offset[2] = 16, cloud.origin = {5e6f, -4.5e6f, 896};
  const auto r = ask(host{}, part, pose, placed{cloud, shifted(5e6, -4.5e6, 896)}, min_distance{});
  wide truth = infinity;
  for (std::size_t k = 0; k < records.size(); k += 3)
    for (const auto& s : primitives)
      truth =
          std::min(truth, exact(s, oracle::moved_back(pose.matrix(), {records[k], records[k + 1], records[k + 2]})));
  CHECK(std::abs(r.distance - truth) < 1e-5);
  CHECK((r.lower <= std::max(truth, wide(0)) && std::max(truth, wide(0)) <= r.upper));
  CHECK(std::abs(r.at.x - records[3 * r.point]) < 1e-6);
}

TEST_CASE("Several robots are asked in one call, each with its own result") {
  const auto s = scenes<inner_sphere>()[0];
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  auto moved = s.poses;
  for (auto& pose : moved) pose.translation() += Eigen::Vector3d(0.1, 0.2, -0.1);
  const std::vector poses{s.poses, moved};
  const placed cloud{point_span(s.points), s.cloud_pose};
  const auto results = clearance::min_distance_per_robot(host{}, std::vector(2, model.view()), poses, cloud);
  REQUIRE(results.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto alone = ask(host{}, model, poses[k], cloud, min_distance{});
    CHECK((same_bits(results[k].distance, alone.distance) && results[k].point == alone.point &&
           results[k].part == alone.part));
  }
  CHECK(results[0].distance != results[1].distance);
  CHECK(clearance::min_distance_per_robot(host{}, std::vector<decltype(model.view())>{},
                                          std::vector<std::vector<Eigen::Isometry3d>>{}, cloud)
            .empty());
  CHECK_THROWS_AS(clearance::min_distance_per_robot(host{}, std::vector(1, model.view()), poses, cloud),
                  std::invalid_argument);
}

}  // namespace minimum_test
