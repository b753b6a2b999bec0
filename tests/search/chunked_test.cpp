// SPDX-License-Identifier: BSD-3-Clause
// A cloud that is read in chunks has the answer of the cloud in memory, in every bit, whatever it skips.
#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/make_model.hpp>
#include <clearance/min_distance.hpp>
#include <clearance/solid/mesh_solid.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstring>

using namespace testing;
using clearance::chunked, clearance::host, clearance::min_distance, clearance::min_distance_per_part, clearance::part_minimum,
    clearance::placed, clearance::point_span, clearance::read_records;

namespace {

bool same_minimum(const part_minimum& a, const part_minimum& b) {
  return same_bits(a.distance, b.distance) && a.cloud == b.cloud && a.point == b.point && a.primitive == b.primitive;
}

/// Asks all at first, then what was not skipped; from poses near and far. `source` is the same points in memory.
template <class Model, class C, class S>
void ask_often(const Model& model, std::vector<Eigen::Isometry3d> poses, chunked<C>& cloud, const S& source, const Eigen::Isometry3d& pose, verdict& v,
               const std::string& what) {
  clearance::chunked_query query(host{}, model);
  std::vector<part_minimum> minima(poses.size());
  for (int round = 0; round < 4; ++round) {
    const placed whole{source, pose};
    v.require(same_result(query(poses, cloud, pose), min_distance(host{}, model, poses, whole)), what, ", round ", round, ": another answer");
    v.require(round > 0 || query.loaded() == source.size(), what, ": the first question did not read all");
    const auto [robot, each] = min_distance_per_part(host{}, model, poses, whole);
    v.require(same_result(query.per_part(poses, cloud, pose, minima), robot), what, ", round ", round, ": another answer by parts");
    v.require(std::ranges::equal(minima, each, same_minimum), what, ", round ", round, ": some part's minimum differs");
    poses[0].translation().x() += round == 1 ? 3 : 0.02;
  }
}

/// Neighbours in order are neighbours in space, so that there is something to skip.
std::vector<vec3> wall(std::size_t points) {
  dice d(5);
  std::vector<vec3> all;
  for (std::size_t i = 0; i < points; ++i) all.push_back({real(double(i) * 20 / double(points) - 10), d.number(-1, 1), d.number(1, 2)});
  for (std::size_t i = 7; i < points; i += 1001) all[i].y = clearance::not_a_number;
  return all;
}
auto arm() {
  dice d(3);
  return clearance::make_model<clearance::sphere>(std::vector{random_primitives<inner_sphere>(d, 50, 0.3, 0.1), random_primitives<inner_sphere>(d, 30, 0.2, 0.1)});
}
const std::vector<Eigen::Isometry3d> arm_poses = {shifted(0, 0, 0), shifted(0.5, 0, 0)};

}  // namespace

TEST_CASE("A cloud in chunks has the answer of the whole: all scenes, spheres from points and images") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    chunked points(all.span, 1);
    ask_often(model, s.poses, points, all.span, s.cloud_pose, v, s.name + ", points");
    chunked image(all.raw);
    ask_often(model, s.poses, image, all.raw, all.camera_pose, v, s.name + ", image");
  }
}

TEST_CASE("Chunks that do not divide the cloud are the cloud, before spheres and before triangles with an interior") {
  verdict v;
  clearance::triangle_mesh box;
  for (int k = 0; k < 8; ++k) box.vertices.emplace_back(k & 1 ? 0.3 : -0.3, k & 2 ? 0.3 : -0.3, k & 4 ? 1.1 : -1.1);
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::vector<decltype(clearance::make_part<clearance::aabb>(clearance::close_mesh(box)))> boxes;
  for (int k = 0; k < 2; ++k) boxes.push_back(clearance::make_part<clearance::aabb>(clearance::close_mesh(box), {.tolerance = 1e-4}));
  const clearance::model solid(std::move(boxes));
  const auto spheres = arm();
  for (const std::size_t n : {0, 1, 4095, 4096, 4097, 50001}) {
    const auto cloud = wall(n);
    for (const std::size_t chunk : {1, 8192, 1 << 20}) {
      const std::string what = std::to_string(n) + " in chunks of " + std::to_string(chunk);
      chunked first(point_span(cloud), chunk), second = first;
      ask_often(spheres, arm_poses, first, point_span(cloud), shifted(0.1, 0, 0), v, what);
      ask_often(solid, arm_poses, second, point_span(cloud), shifted(0.1, 0, 0), v, what + ", solid");
    }
  }
}

TEST_CASE("Records that are read have the answer of those in memory, and a failure of the reader is told") {
  verdict v;
  const auto cloud = wall(100003);
  int reads = 0, fails_at = -1;
  std::size_t most = 0;
  const auto read = [&](std::size_t offset, std::span<std::byte> to) {
    if (reads++ == fails_at) throw std::runtime_error("the link is down");
    most = std::max(most, to.size());
    std::memcpy(to.data(), reinterpret_cast<const std::byte*>(cloud.data()) + offset, to.size());
  };
  const auto view = [](const std::byte* memory, std::size_t n) { return point_span(reinterpret_cast<const vec3*>(memory), n); };
  const read_records records(cloud.size(), sizeof(vec3), read, view);
  const auto model = arm();
  chunked in_chunks(records, 8192);
  ask_often(model, arm_poses, in_chunks, point_span(cloud), shifted(0, 0, 0), v, "read");
  CHECK(most == 8192 * sizeof(vec3));

  const auto expected = min_distance(host{}, model, arm_poses, cloud);
  clearance::chunked_query query(host{}, model);
  for (const int k : {0, 1, 12}) {
    in_chunks.forget();
    reads = 0, fails_at = k;
    CHECK_THROWS_WITH(query(arm_poses, in_chunks), "the link is down");
    CHECK(in_chunks.pieces().empty());
    fails_at = -1;
    CHECK(same_result(query(arm_poses, in_chunks), expected));
  }
}

TEST_CASE("The second question about a cloud reads what can matter") {
  const auto cloud = wall(400000);
  const auto model = arm();
  chunked in_chunks(point_span(cloud), 16384);
  clearance::chunked_query query(host{}, model);
  query(arm_poses, in_chunks);
  CHECK(query.loaded() == cloud.size());
  const auto again = query(arm_poses, in_chunks);
  CHECK(query.loaded() < cloud.size() / 4);
  CHECK((again.seen == cloud.size() && again.valid == cloud.size() - (cloud.size() + 993) / 1001));
  in_chunks.forget();
  query(arm_poses, in_chunks);
  CHECK(query.loaded() == cloud.size());
}

TEST_CASE("More points than numbers are refused, and so are poses that are none") {
  const auto none = [](std::size_t, std::span<std::byte>) {};
  const auto view = [](const std::byte* memory, std::size_t n) { return point_span(reinterpret_cast<const vec3*>(memory), n); };
  CHECK_NOTHROW(chunked(read_records((std::size_t(1) << 32) - 2, 12, none, view)));
  CHECK_THROWS_WITH(chunked(read_records((std::size_t(1) << 32) - 1, 12, none, view)),
                    "clearance: a cloud of 4294967295 points; one has at most 2^32 - 2");
  const auto cloud = wall(9000);
  const auto model = arm();
  for (const std::size_t all_at_once : {~std::size_t(0), ~std::size_t(0) - 4096}) CHECK(chunked(point_span(cloud), all_at_once).all().size() == 1);
  chunked in_chunks{point_span(cloud)};
  clearance::chunked_query query(host{}, model);
  for (int round = 0; round < 2; ++round) {
    CHECK_THROWS_AS(query({arm_poses.data(), 1}, in_chunks), std::invalid_argument);
    Eigen::Isometry3d skewed = arm_poses[0];
    skewed.linear() *= 1.01;
    CHECK_THROWS_AS(query(arm_poses, in_chunks, skewed), std::invalid_argument);
    CHECK(same_result(query(arm_poses, in_chunks), min_distance(host{}, model, arm_poses, cloud)));
  }
}
