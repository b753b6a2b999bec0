// SPDX-License-Identifier: BSD-3-Clause
// The prepared query on the host, and the tiles by which every search there reads points: the answer of brute force in
// every bit, cold, warm, and after anything has moved; and no allocation once it has run.
#include "support/frame_after_frame.hpp"
#include "support/product.hpp"

#include <clearance/points/depth_image.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdlib>
#include <new>

namespace {
thread_local std::size_t allocations = 0;
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace prepared_test {

using namespace testing;
using clearance::host, clearance::min_distance, clearance::min_distance_per_part, clearance::placed,
    clearance::point_span;

namespace {

/// Cold, warm, moved and moved back; with one bound for all and one a part; against brute force.
template <class Model, class P, class S>
void ask_often(const Model& model, const scene<P>& s, const S& source, const Eigen::Isometry3d& pose, unsigned threads,
               verdict& v, const std::string& what) {
  auto poses = s.poses;
  const auto parts = brute_parts(s);
  clearance::query query(host{threads}, model, min_distance{});
  clearance::query by_parts(host{threads}, model, min_distance_per_part{});
  const auto same = [&](const std::string& when) {
    const auto expected = brute_force(parts, poses, {brute_cloud(source, pose)});
    require_equal(query(poses, source, pose), expected, v, what + ", " + when);
    const auto& [robot, minima] = by_parts(poses, placed<S>{source, pose});
    require_equal(robot, expected, v, what + ", per part, " + when);
    require_equal(minima, expected, v, what + ", " + when);
  };
  frame_after_frame(poses, same, [&] { query.forget(), by_parts.forget(); });
}

template <class V, class P>
void ask_all_scenes() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    for (const unsigned threads : {1u, 2u, 0u}) {
      const std::string what = s.name + ", threads " + std::to_string(threads);
      ask_often(model, s, all.span, s.cloud_pose, threads, v, what + ", span");
      ask_often(model, s, all.doubles, s.cloud_pose, threads, v, what + ", doubles");
      ask_often(model, s, all.raw, all.camera_pose, threads, v, what + ", 16-bit image");
      ask_often(model, s, all.metres, all.camera_pose, threads, v, what + ", float image");
    }
  }
}

/// A robot of two parts before something as large as a frame.
scene<inner_sphere> robot(dice& d) {
  return {"robot",
          {random_primitives<inner_sphere>(d, 300, 0.2, 0.05), random_primitives<inner_sphere>(d, 200, 0.2, 0.05)},
          {shifted(0, 0, 0), shifted(0.7, 0.2, 0)},
          {}};
}

template <class S>
void ask_frame(const scene<inner_sphere>& s, const S& source, const Eigen::Isometry3d& pose, verdict& v,
               const std::string& what) {
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  for (const unsigned threads : {1u, 2u}) ask_often(model, s, source, pose, threads, v, what);
}

}  // namespace

TEST_CASE("The prepared query says what brute force says, to spheres") {
  ask_all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("The prepared query says what brute force says, to triangles") {
  ask_all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("Whole tiles, tiles cut short, and every way to be no point, counted one by one") {
  verdict v;
  dice d(8);
  scene<inner_sphere> s = robot(d);
  const real bad[] = {clearance::not_a_number, clearance::infinity, -clearance::infinity, 2e18f, -2e18f};
  for (const std::size_t n : {127, 128, 129, 1024, 20000, 20477}) {
    for (const int holes : {0, 1, 2, 3, 4}) {
      s.points = d.points(n, 2, {0, 0, 3});
      for (std::size_t k = 0; k < n; ++k) {
        vec3& p = s.points[k];
        if (holes == 1 && k % 9 == 4) (&p.x)[d.below(3)] = bad[d.below(5)];
        if (holes == 2 && k / 128 % 3 == 1) p = {bad[0], bad[0], bad[0]};  // whole tiles
        if (holes == 3 && k / 64 % 3 == 1) (&p.x)[k / 128 % 3] = bad[d.below(5)];
        if (holes == 4) p = {bad[0], bad[0], bad[0]};
      }
      const std::string what = std::to_string(n) + " points, holes " + std::to_string(holes);
      ask_frame(s, point_span(s.points), s.cloud_pose, v, what);
      ask_frame(s, point_span(s.points, {.nearest = 1.5f, .farthest = 3.2f}), s.cloud_pose, v, what + ", filtered");
    }
  }
}

TEST_CASE("Images of any width, with padded rows, cut short by nearest and farthest, on either side of the lens") {
  verdict v;
  dice d(9);
  const scene<inner_sphere> s = robot(d);
  for (const std::uint32_t width : {64u, 100u, 160u, 1001u}) {
    const std::uint32_t height = 20000 / width, row = width + (width == 160 ? 5 : 0);
    std::vector<std::uint16_t> raw(row * height);
    std::vector<real> metres(row * height);
    for (std::size_t k = 0; k < raw.size(); ++k) {
      raw[k] = d.below(9) == 0    ? 0
               : d.below(19) == 0 ? 65535
                                  : std::uint16_t(1500 + 300 * (k / 999 % 3) + d.below(100));
      metres[k] = raw[k] == 0       ? (d.below(2) ? 0 : clearance::not_a_number)
                  : raw[k] == 65535 ? clearance::infinity
                                    : raw[k] * 0.001f;
      if (k / 700 % 2 == 1 && !(metres[k] > 0)) metres[k] = 0;  // missing alone, as real cameras say it
    }
    const clearance::intrinsics camera{double(width), double(width), width / 2.0, height / 2.0};
    clearance::depth_image image(raw.data(), width, height, camera);
    clearance::depth_image floats(metres.data(), width, height, camera);
    image.row = floats.row = row;
    for (const double away : {-2.4, -100.0}) {  // at 100 m the search moves its origin
      const auto pose = shifted(0.1, 0, away);
      const std::string what = "width " + std::to_string(width) + " from " + std::to_string(away);
      ask_frame(s, image, pose, v, what);
      ask_frame(s, floats, pose, v, what + ", floats");
      auto cut = image;
      cut.nearest = 1.6f, cut.farthest = 2.0f;
      ask_frame(s, cut, pose, v, what + ", cut");
      auto cut_floats = floats;
      cut_floats.nearest = 1.6f, cut_floats.farthest = 2.0f;
      ask_frame(s, cut_floats, pose, v, what + ", cut floats");
      auto mirrored = image;
      mirrored.inverse_fx = -mirrored.inverse_fx;
      ask_frame(s, mirrored, pose, v, what + ", mirrored");
    }
  }
}

TEST_CASE("Frames of another size, none, and several at once follow one another in one query") {
  verdict v;
  dice d(10);
  const scene<inner_sphere> s = robot(d);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto parts = brute_parts(s);
  clearance::query query(host{2}, model, min_distance{});
  for (const std::size_t n : {9000, 40, 0, 1, 9000, 300}) {
    const auto near = d.points(n, 2, {0, 0, 3}), far = d.points(n / 2, 2, {0, 3, 3});
    const std::vector<placed<point_span>> clouds = {{far, shifted(0, 0, 0.5)}, {near}, {far}};
    std::vector<brute_cloud> brute;
    for (const auto& c : clouds) brute.emplace_back(c.source, c.pose);
    require_equal(query(s.poses, clouds), brute_force(parts, s.poses, brute), v, "several");
    require_equal(query(s.poses, near), brute_force(parts, s.poses, {brute_cloud(point_span(near))}), v, "one");
  }
}

TEST_CASE("After its first frames a prepared query asks for no memory") {
  dice d(11);
  const scene<inner_sphere> s = robot(d);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto points = d.points(20000, 2, {0, 0, 3});
  clearance::query query(host{1}, model, min_distance{});
  clearance::query by_parts(host{1}, model, min_distance_per_part{});
  auto poses = s.poses;
  std::size_t before = 0;
  for (int frame = 0; frame < 8; ++frame) {
    if (frame == 2) before = allocations;
    poses[0].translation().x() += 0.01;
    query(poses, points);
    by_parts(poses, points);
  }
  CHECK(before > 0);
  CHECK(allocations == before);
}

TEST_CASE("So does one about what a camera hides, with its own shadow, radii and edges") {
  dice d(13);
  const scene<inner_sphere> s = robot(d);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  std::vector<float> pixels(160 * 120);
  std::vector<clearance::point_label> labels(pixels.size(), clearance::point_label::rest);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = d.number(2, 3);
    if (d.below(9) == 0) labels[i] = clearance::point_label::own;
  }
  const clearance::depth_image<float> image(pixels.data(), 160, 120, {150, 150, 80, 60});
  const clearance::unseen asked{.labels = labels, .edges = true, .radii = {0.01, 0.02}};
  clearance::query query(host{1}, model, asked);
  auto poses = s.poses;
  std::size_t before = 0;
  double own = 0;
  for (int frame = 0; frame < 8; ++frame) {
    if (frame == 2) before = allocations;
    poses[0].translation().x() += 0.01;
    own += query(poses, image).own_shadow.lower;
  }
  CHECK(own >= 0);
  CHECK(allocations == before);
}

TEST_CASE("A wrong number of poses, and a pose that is not rigid, are refused, and the next frame is answered") {
  dice d(12);
  const scene<inner_sphere> s = robot(d);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto points = d.points(500, 2, {0, 0, 3});
  clearance::query query(host{}, model, min_distance{});
  clearance::query by_parts(host{}, model, min_distance_per_part{});
  const std::vector one(s.poses.begin(), s.poses.begin() + 1);
  CHECK_THROWS_AS(query(one, points), std::invalid_argument);
  CHECK_THROWS_AS(by_parts(one, points), std::invalid_argument);
  auto bent = s.poses;
  bent[1].linear() *= 2;
  CHECK_THROWS_AS(query(bent, points), std::invalid_argument);
  CHECK_THROWS_AS(by_parts(bent, points), std::invalid_argument);
  verdict v;
  const auto expected = brute_force(brute_parts(s), s.poses, {brute_cloud(point_span(points))});
  require_equal(query(s.poses, points), expected, v, "after errors");
  require_equal(by_parts(s.poses, points).parts, expected, v, "after errors");
}

}  // namespace prepared_test
