// SPDX-License-Identifier: BSD-3-Clause
// A cloud that is read in chunks gives the answer of the cloud in memory, in every bit, whatever is skipped.
#include "solid/shapes.hpp"
#include "support/chunked.hpp"
#include "support/product.hpp"

#include <clearance/solid/mesh_solid.hpp>
#include <clearance/volume/aabb.hpp>

#include <cstring>

namespace chunked_query_test {

using namespace testing;
using clearance::chunked, clearance::host, clearance::min_distance, clearance::point_span, clearance::read_records;

TEST_CASE("A cloud in chunks has the answer of the whole: all scenes, spheres from points and images") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    chunked points(all.span, 1);
    ask_often(host{}, model, s.poses, points, all.span, s.cloud_pose, v, s.name + ", points");
    chunked image(all.raw);
    ask_often(host{}, model, s.poses, image, all.raw, all.camera_pose, v, s.name + ", image");
  }
}

TEST_CASE("Chunks that do not divide the cloud are the cloud, before spheres and before triangles with an interior") {
  verdict v;
  const auto box = shapes::box({-0.3, -0.3, -1.1}, {0.3, 0.3, 1.1});
  std::vector<decltype(clearance::make_part<clearance::aabb>(clearance::close_mesh(box)))> boxes;
  for (int k = 0; k < 2; ++k)
    boxes.push_back(clearance::make_part<clearance::aabb>(clearance::close_mesh(box), {.tolerance = 1e-4}));
  const clearance::model solid(std::move(boxes));
  const auto spheres = arm();
  for (const std::size_t n : {0, 1, 4095, 4096, 4097, 50001}) {
    const auto cloud = wall(n);
    for (const std::size_t chunk : {1, 8192, 1 << 20}) {
      const std::string what = std::to_string(n) + " in chunks of " + std::to_string(chunk);
      chunked first(point_span(cloud), chunk), second = first;
      ask_often(host{}, spheres, arm_poses, first, point_span(cloud), shifted(0.1, 0, 0), v, what);
      ask_often(host{}, solid, arm_poses, second, point_span(cloud), shifted(0.1, 0, 0), v, what + ", solid");
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
  const read_records records(cloud.size(), sizeof(vec3), read, points_at);
  const auto model = arm();
  chunked in_chunks(records, 8192);
  ask_often(host{}, model, arm_poses, in_chunks, point_span(cloud), shifted(0, 0, 0), v, "read");
  CHECK(most == 8192 * sizeof(vec3));

  const auto expected = ask(host{}, model, arm_poses, cloud, min_distance{});
  clearance::chunked_query query(host{}, model, min_distance{});
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
  clearance::chunked_query query(host{}, model, min_distance{});
  query(arm_poses, in_chunks);
  CHECK(query.loaded() == cloud.size());
  const auto again = query(arm_poses, in_chunks);
  CHECK(query.loaded() < cloud.size() / 4);
  CHECK((again.seen == cloud.size() && again.valid == cloud.size() - (cloud.size() + 993) / 1001));
  in_chunks.forget();
  query(arm_poses, in_chunks);
  CHECK(query.loaded() == cloud.size());
}

TEST_CASE("What matters in many places is one search on the host, in chunks of points where they have to be brought") {
  verdict v;
  std::vector<vec3> cloud;
  for (int turn = 0; turn < 30; ++turn) {  // the robot is passed once a turn
    const auto more = wall(2 * 4096);
    cloud.insert(cloud.end(), more.begin(), more.end());
  }
  cloud.resize(cloud.size() - 1000);
  std::vector<std::size_t> loads;  // points of each search: the host asks for the whole once it has loaded them
  std::size_t so_far = 0;
  struct counted {
    const std::vector<vec3>* points;
    std::vector<std::size_t>* loads;
    std::size_t* so_far;
    std::size_t size() const { return points->size(); }
    std::size_t bytes_for(std::size_t) const { return 0; }
    point_span whole() const {
      loads->push_back(std::exchange(*so_far, 0));
      return point_span(*points);
    }
    point_span load(std::size_t begin, std::size_t end, std::byte*) const {
      *so_far += end - begin;
      return point_span(*points).slice(begin, end);
    }
  };
  STATIC_REQUIRE((clearance::addressed_cloud<counted> && clearance::addressed_cloud<clearance::in_memory<point_span>>));
  const auto model = arm();
  for (const std::size_t chunk : {1, 20000, 1 << 20}) {
    const std::string what = "turns in chunks of " + std::to_string(chunk);
    chunked in_chunks(counted{&cloud, &loads, &so_far}, chunk);
    chunked in_place(point_span(cloud), chunk);
    ask_often(host{}, model, arm_poses, in_chunks, point_span(cloud), shifted(0.1, 0, 0), v, what + ", brought");
    ask_often(host{}, model, arm_poses, in_place, point_span(cloud), shifted(0.1, 0, 0), v, what + ", in place");
    v.require(std::ranges::max(loads) <= in_chunks.chunk(), what, ": more than a chunk is loaded at a time");
    loads.clear();
  }
}

TEST_CASE("A cloud that loads what was not asked for is refused, and one that grows is as large as it was") {
  const auto points = wall(20000);
  struct liar {
    const std::vector<vec3>* points;
    std::ptrdiff_t more = 0;
    std::size_t size() const { return 10000 + std::size_t(more); }
    std::size_t bytes_for(std::size_t) const { return 0; }
    point_span load(std::size_t begin, std::size_t end, std::byte*) const {
      return {points->data() + begin, end - begin + std::size_t(more)};
    }
  };
  const auto model = arm();
  clearance::chunked_query query(host{}, model, min_distance{});
  for (const int more : {-1, 1}) {
    chunked in_chunks(liar{&points, more}, 4096);
    CHECK_THROWS_WITH(query(arm_poses, in_chunks),
                      "clearance: a cloud was to load 4096 points, and loaded " + std::to_string(4096 + more));
    CHECK(in_chunks.pieces().empty());
  }
  std::size_t there = 10000;
  struct growing {
    const std::vector<vec3>* points;
    const std::size_t* there;
    std::size_t size() const { return *there; }
    std::size_t bytes_for(std::size_t) const { return 0; }
    point_span load(std::size_t begin, std::size_t end, std::byte*) const {
      return {points->data() + begin, end - begin};
    }
  };
  chunked in_chunks(growing{&points, &there});
  const auto expected = ask(host{}, model, arm_poses, point_span(points.data(), 10000), min_distance{});
  for (int round = 0; round < 2; ++round, there = 20000) CHECK(same_result(query(arm_poses, in_chunks), expected));
}

TEST_CASE("More points than numbers are refused, and so are poses that are none") {
  const auto none = [](std::size_t, std::span<std::byte>) {};
  CHECK_NOTHROW(chunked(read_records((std::size_t(1) << 32) - 2, 12, none, points_at)));
  CHECK_THROWS_WITH(chunked(read_records((std::size_t(1) << 32) - 1, 12, none, points_at)),
                    "clearance: a cloud of 4294967295 points; one has at most 2^32 - 2");
  CHECK_THROWS_WITH(read_records(9, 0, none, points_at), "clearance: 9 records of 0 bytes");
  CHECK_THROWS_WITH(read_records(9, ~std::size_t(0) / 8, none, points_at),
                    "clearance: 9 records of 2305843009213693951 bytes");
  const auto cloud = wall(9000);
  const auto model = arm();
  for (const std::size_t least : {0, 1}) CHECK(chunked(point_span(cloud), least).all().size() == 3);
  for (const std::size_t all_at_once : {~std::size_t(0), ~std::size_t(0) - 4096})
    CHECK(chunked(point_span(cloud), all_at_once).all().size() == 1);
  chunked in_chunks{point_span(cloud)};
  clearance::chunked_query query(host{}, model, min_distance{});
  for (int round = 0; round < 2; ++round) {
    CHECK_THROWS_AS(query(std::span(arm_poses).first(1), in_chunks), std::invalid_argument);
    Eigen::Isometry3d skewed = arm_poses[0];
    skewed.linear() *= 1.01;
    CHECK_THROWS_AS(query(arm_poses, in_chunks, skewed), std::invalid_argument);
    CHECK(same_result(query(arm_poses, in_chunks), ask(host{}, model, arm_poses, cloud, min_distance{})));
  }
}

}  // namespace chunked_query_test
