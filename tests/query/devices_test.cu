// SPDX-License-Identifier: BSD-3-Clause
// Several devices together give the host's answer, in every bit. One GPU is named more than once, as are several of
// them; if there are two, both are asked, and the second alone.
#include "solid/shapes.hpp"
#include "support/closed.hpp"
#include "support/configurations.hpp"
#include "support/counted_memory.cuh"
#include "support/frame_after_frame.hpp"
#include "support/held_stream.cuh"
#include "support/product_device.cuh"
#include "support/too_close_frame.hpp"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace devices_test {

using namespace testing;
using clearance::device, clearance::devices, clearance::host, clearance::min_distance, clearance::min_distance_per_part,
    clearance::placed, clearance::point_span, clearance::sharded;

namespace {

int gpus() {
  int count = 0;
  check(cudaGetDeviceCount(&count));
  return count;
}
int current() {
  int id = -1;
  check(cudaGetDevice(&id));
  return id;
}

struct named {
  std::string name;
  devices on;
};
std::vector<named> all_devices() {
  std::vector<named> all = {{"0 0", devices{0, 0}}, {"0 0 0", devices{0, 0, 0}}};
  if (gpus() > 1) {
    all.push_back({"0 1", devices{0, 1}});
    all.push_back({"1", devices{1}});
    all.push_back({"1 0 1 1 0", devices{1, 0, 1, 1, 0}});
  }
  return all;
}

/// Cold, warm, moved and moved back; one call, and every part's minimum. `clouds` is for the devices, `same` for the
/// host.
template <class Model, class Clouds, class Same>
void ask_often(const devices& on, const Model& on_host, std::vector<Eigen::Isometry3d> poses, const Clouds& clouds,
               const Same& same, verdict& v, const std::string& what) {
  const auto model = on_host.on(on);
  clearance::query query(on, model, min_distance{});
  clearance::query per_part(on, model, min_distance_per_part{});
  const auto compare = [&](const std::string& when) {
    const auto expected = ask(host{}, on_host, poses, same, min_distance{});
    v.require(same_result(query(poses, clouds), expected), what, ", ", when, ": differs from the host's result");
    const auto [robot, each] = ask(host{}, on_host, poses, same, min_distance_per_part{});
    const auto [found, minima] = per_part(poses, clouds);
    v.require(same_result(found, robot), what, ", ", when, ": differs from the host's result by parts");
    v.require(std::ranges::equal(minima, each, same_minimum), what, ", ", when, ": some part's minimum differs");
  };
  frame_after_frame(poses, compare, [&] { query.forget(), per_part.forget(); });
  v.require(
      same_result(ask(on, model, poses, clouds, min_distance{}), ask(host{}, on_host, poses, same, min_distance{})),
      what, ": one call differs");
  const auto [robot, each] = ask(on, model, poses, clouds, min_distance_per_part{});
  const auto [expected, its] = ask(host{}, on_host, poses, same, min_distance_per_part{});
  v.require(same_result(robot, expected) && std::ranges::equal(each, its, same_minimum), what,
            ": one call differs by parts");
}

template <class P, class V>
auto model_of(const scene<P>& s) {
  return make_model<V>(s, {}, clearance::wrapped{});
}

auto robot_of(dice& d, int parts, int spheres) {
  std::vector<clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>> made;
  for (int k = 0; k < parts; ++k)
    made.push_back(clearance::make_part(
        clearance::build<clearance::sphere>(random_primitives<inner_sphere>(d, spheres, 0.3, 0.02))));
  return clearance::model(std::move(made));
}
std::vector<Eigen::Isometry3d> poses_of(dice& d, int parts) {
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < parts; ++k) poses.push_back(d.pose(1));
  return poses;
}

/// A cloud cut where one likes, each piece in the memory of its device.
class cut_by_hand {
 public:
  cut_by_hand(const devices& on, const std::vector<vec3>& points, const std::vector<std::size_t>& cuts) {
    std::vector<point_span> pieces;
    for (std::size_t k = 0; k < on.size(); ++k) {
      const std::size_t begin = std::min(cuts[k], points.size()), end = std::min(cuts[k + 1], points.size());
      memory_.push_back(on.each()[k].copy_in(std::span(points).subspan(begin, end - begin)));
      pieces.emplace_back(memory_.back().data(), end - begin);
    }
    view_.emplace(pieces);
  }
  const sharded<point_span>& view() const { return *view_; }

 private:
  std::vector<clearance::device_buffer<vec3>> memory_;
  std::optional<sharded<point_span>> view_;
};

}  // namespace

TEST_CASE("Several devices equal the host in all scenes: spheres, from points and images in host memory") {
  verdict v;
  for (const auto& [name, on] : all_devices())
    for (const auto& s : scenes<inner_sphere>()) {
      const sources<inner_sphere> all(s);
      const auto model = model_of<inner_sphere, clearance::sphere>(s);
      const placed points{all.span, s.cloud_pose};
      ask_often(on, model, s.poses, points, points, v, s.name + ", points on " + name);
      const placed image{all.raw, all.camera_pose};
      ask_often(on, model, s.poses, image, image, v, s.name + ", image on " + name);
    }
}

TEST_CASE("Several devices equal the host in all scenes: triangles in boxes, of which points stay on the devices",
          "[slow]") {
  verdict v;
  for (const auto& [name, on] : all_devices())
    for (const auto& s : scenes<triangle>()) {
      const auto model = model_of<triangle, clearance::aabb>(s);
      const auto there = clearance::shard(on, s.points);
      ask_often(on, model, s.poses, placed{there.view(), s.cloud_pose}, placed{point_span(s.points), s.cloud_pose}, v,
                s.name + " on " + name);
    }
}

TEST_CASE("Points inside triangle parts are found on any device") {
  dice d(7);
  verdict v;
  std::vector<decltype(clearance::make_part<clearance::aabb>(clearance::close_mesh(shapes::cube(1))))> parts;
  for (const double half : {0.2, 0.3, 0.1})
    parts.push_back(
        clearance::make_part<clearance::aabb>(clearance::close_mesh(shapes::cube(half)), {.tolerance = 1e-4}));
  const clearance::model robot(std::move(parts));
  const auto poses = poses_of(d, 3);
  for (const auto& [name, on] : all_devices())
    for (const double half : {0.05, 0.5, 2.0}) {
      const auto cloud = d.points(5003, half);
      ask_often(on, robot, poses, cloud, cloud, v, "boxes, cloud of " + std::to_string(half) + " on " + name);
    }
}

TEST_CASE("Any number of points, parts and devices is exact; also more devices than points") {
  dice d(5);
  verdict v;
  auto all = all_devices();
  all.push_back({"sixteen", devices(std::vector<int>(16, gpus() - 1))});
  for (const int parts : {1, 7, 130}) {
    const auto robot = robot_of(d, parts, parts > 100 ? 5 : 60);
    const auto poses = poses_of(d, parts);
    for (const int points : {0, 1, 2, 3, 5, 17, 33, 2047, 2049, 30011}) {
      if (parts > 100 && points % 16 != 1) continue;
      const auto cloud = d.points(std::size_t(points), 2);
      for (const auto& [name, on] : all) {
        const std::string what = std::to_string(parts) + " parts, " + std::to_string(points) + " points on " + name;
        ask_often(on, robot, poses, placed{point_span(cloud), poses[0]}, placed{point_span(cloud), poses[0]}, v, what);
      }
    }
  }
}

TEST_CASE("Shards of any size are one cloud: unequal ones, empty ones, odd addresses") {
  dice d(14);
  verdict v;
  const auto robot = robot_of(d, 3, 60);
  const auto poses = poses_of(d, 3);
  const auto points = d.points(20011, 2);
  const std::vector<std::vector<std::size_t>> all_cuts = {{0, 1, 20011, 20011, 20011, 20011},
                                                          {0, 0, 0, 0, 0, 20011},
                                                          {0, 4001, 4002, 4002, 19999, 20011},
                                                          {0, 20011, 20011, 20011, 20011, 20011}};
  for (const auto& [name, on] : all_devices())
    for (auto cuts : all_cuts) {
      cuts[on.size()] = points.size();
      const cut_by_hand there(on, points, cuts);
      ask_often(on, robot, poses, there.view(), points, v, "first of " + std::to_string(cuts[1]) + " on " + name);
    }
}

TEST_CASE("Several clouds of several kinds, resident or not, are numbered and counted as one call's") {
  dice d(9);
  verdict v;
  const auto scene = scenes<inner_sphere>()[0];
  const sources<inner_sphere> image(scene);
  const auto robot = robot_of(d, 5, 60);
  const auto poses = poses_of(d, 5);
  const std::vector<vec3> blind(301, vec3{clearance::not_a_number, 0, 0}), empty;
  const auto near = d.points(5003, 3), far = d.points(20001, 2), one = d.points(1, 2);
  std::vector<Eigen::Isometry3d> stands;
  for (int k = 0; k < 6; ++k) stands.push_back(d.pose(0.2));
  stands[3] = shifted(1e5, 0, 0);  // its errors are in every cloud's bracket
  for (const auto& [name, on] : all_devices()) {
    const auto shards = clearance::shard(on, far);
    const auto few = clearance::shard(on, one);
    const auto clouds = [&](const auto& far_points, const auto& one_point) {
      return std::tuple(placed{point_span(near), stands[0]}, placed{point_span(empty), stands[1]},
                        placed{point_span(blind), stands[2]}, placed{one_point, stands[3]},
                        placed{far_points, stands[4]}, placed{image.raw, stands[5]});
    };
    ask_often(on, robot, poses, clouds(shards.view(), few.view()), clouds(point_span(far), point_span(one)), v,
              "six clouds on " + name);
    std::vector<placed<point_span>> some;
    for (const auto* points : {&blind, &far, &empty, &near}) some.push_back({point_span(*points), stands[some.size()]});
    ask_often(on, robot, poses, some, some, v, "a vector of clouds on " + name);
    const std::vector<placed<point_span>> none;
    ask_often(on, robot, poses, none, none, v, "no cloud on " + name);
  }
}

TEST_CASE("Equally near points in all shards: the lowest wins") {
  verdict v;
  const std::vector<inner_sphere> ball = {{{0, 0, 0}, 0.5f}};
  const auto robot = clearance::make_model<clearance::sphere>(std::vector<std::vector<inner_sphere>>{ball, ball});
  const std::vector<Eigen::Isometry3d> poses = {shifted(0, 0, 0), shifted(0, 0, 0)};
  std::vector<vec3> same(3001, vec3{2, 0, 0});
  for (const std::size_t first : {0, 1, 1499, 1500, 1504, 2999}) {
    std::fill_n(same.begin(), first, vec3{3, 0, 0});
    for (const auto& [name, on] : all_devices()) {
      const auto model = robot.on(on);
      const auto r = ask(on, model, poses, same, min_distance{});
      v.require(r.point == first && r.part == 0 && r.distance == 1.5f, "from ", first, " on ", name, ": point ",
                r.point);
      ask_often(on, robot, poses, same, same, v, "ties from " + std::to_string(first) + " on " + name);
    }
  }
}

TEST_CASE("Only the nearest pair says whether a point is certainly inside a part of spheres, as on one device") {
  // A point 3 mm inside a part that is only good to 1 cm, and in another shard one 2 mm inside a part that is exact.
  const std::vector<inner_sphere> ball = {{{0, 0, 0}, 1}};
  const auto tree = clearance::build<clearance::sphere>(ball);
  const clearance::model robot(std::vector{clearance::make_part(tree, 0, 0.01), clearance::make_part(tree)});
  const std::vector<Eigen::Isometry3d> poses = {shifted(-5, 0, 0), shifted(5, 0, 0)};
  const std::vector<vec3> points = {{-4.003f, 0, 0}, {0, 9, 0}, {0, 9, 0}, {0, 9, 0}, {4.002f, 0, 0}};
  verdict v;
  REQUIRE(ask(host{}, robot, poses, points, min_distance{}).state == clearance::state::possible);
  for (const auto& [name, on] : all_devices()) ask_often(on, robot, poses, points, points, v, name);
}

TEST_CASE(
    "Clouds in pinned memory and in any device's memory are found where they are, and where they have become others") {
  dice d(13);
  verdict v;
  const auto robot = robot_of(d, 3, 60);
  const auto poses = poses_of(d, 3);
  const clearance::pinned_buffer<vec3> pinned(3001, 0);
  for (const auto& [name, on] : all_devices()) {
    const auto model = robot.on(on);
    clearance::query query(on, model, clearance::min_distance{});
    for (int round = 0; round < 3; ++round) {
      const auto points = d.points(pinned.size(), 2);
      std::ranges::copy(points, pinned.data());
      const auto expected = ask(host{}, robot, poses, points, min_distance{});
      v.require(same_result(query(poses, point_span(pinned.data(), pinned.size())), expected), "pinned, on ", name,
                ": differs");
      for (int id = 0; id < gpus(); ++id) {
        const auto there = device{id}.copy_in(std::span<const vec3>(points));
        v.require(same_result(query(poses, point_span(there.data(), there.size())), expected), "in the memory of ", id,
                  ", on ", name, ": differs");
        const auto shards = clearance::shard(on, point_span(there.data(), there.size()));
        v.require(same_result(query(poses, shards.view()), expected), "sharded from the memory of ", id, ", on ", name,
                  ": differs");
      }
    }
  }
}

TEST_CASE("One device, whose memory the cloud is not in, copies it, too") {
  if (gpus() < 2) return;
  dice d(17);
  const auto robot = robot_of(d, 2, 60);
  const auto poses = poses_of(d, 2);
  const auto points = d.points(3000, 2);
  const auto there = device{1}.copy_in(std::span<const vec3>(points));
  const auto model = robot.on(device{0});
  clearance::query query(device{0}, model, clearance::min_distance{});
  CHECK(same_result(query(poses, point_span(there.data(), there.size())),
                    ask(host{}, robot, poses, points, min_distance{})));
}

TEST_CASE("Streams of the caller's are taken, and the caller's device stays", "[concurrent]") {
  dice d(15);
  verdict v;
  const auto robot = robot_of(d, 3, 60);
  const auto poses = poses_of(d, 3);
  const auto points = d.points(3001, 2);
  for (int id = 0; id < gpus(); ++id) {
    check(cudaSetDevice(id));
    const own_stream one, two;
    {
      const devices on(std::vector{device{id, one.handle}, device{id, two.handle}});
      ask_often(on, robot, poses, points, points, v, "streams of " + std::to_string(id));
      CHECK(current() == id);
      const auto model = robot.on(on);
      clearance::query query(on, model, clearance::min_distance{});
      CHECK(same_result(query(poses, points), ask(host{}, robot, poses, points, min_distance{})));
      gate held(two.handle);  // the answer waits for the second stream, and only for that
      std::thread later([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        held.release();
      });
      const auto start = std::chrono::steady_clock::now();
      const auto r = query(poses, points);
      CHECK(std::chrono::steady_clock::now() - start > std::chrono::milliseconds(20));
      later.join();
      CHECK(same_result(r, ask(host{}, robot, poses, points, min_distance{})));
    }
    for (const auto& [name, on] : all_devices()) {
      const auto model = robot.on(on);
      const auto shards = clearance::shard(on, points);
      CHECK(current() == id);
      clearance::query query(on, model, clearance::min_distance{});
      v.require(same_result(query(poses, shards.view()), ask(host{}, robot, poses, points, min_distance{})), name,
                " from device ", id, ": differs");
      CHECK(current() == id);
      CHECK_THROWS_AS(query(std::span(poses).first(1), points), std::invalid_argument);
      CHECK(current() == id);
    }
  }
  check(cudaSetDevice(0));
}

TEST_CASE("Streams of one's own come behind what is in a device's default stream", "[concurrent]") {
  dice d(16);
  const auto robot = robot_of(d, 2, 60);
  const auto poses = poses_of(d, 2);
  const auto before = d.points(3000, 2), after = d.points(3000, 2);
  const devices on{0, 0};
  const auto model = robot.on(on);
  clearance::query query(on, model, clearance::min_distance{});
  const auto there = device{}.copy_in(std::span<const vec3>(before)),
             next = device{}.copy_in(std::span<const vec3>(after));
  const sharded cloud(std::vector{point_span(there.data(), 1500), point_span(there.data() + 1500, 1500)});
  CHECK(same_result(query(poses, cloud), ask(host{}, robot, poses, before, min_distance{})));
  check(
      cudaLaunchHostFunc(nullptr, [](void*) { std::this_thread::sleep_for(std::chrono::milliseconds(30)); }, nullptr));
  check(cudaMemcpyAsync(there.data(), next.data(), 3000 * sizeof(vec3), cudaMemcpyDeviceToDevice, nullptr));
  CHECK(same_result(query(poses, cloud), ask(host{}, robot, poses, after, min_distance{})));
}

namespace {

/// What a call is refused with.
template <class F>
std::string refused(F call) {
  try {
    call();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "not refused";
}

}  // namespace

TEST_CASE("What cannot be is refused with a sentence, and leaves nothing behind") {
  dice d(8);
  const int there = gpus();
  static_assert(!std::is_default_constructible_v<devices>);
  CHECK(refused([] { devices(std::vector<int>()); }) == "clearance: devices, but not one of them");
  CHECK(refused([] { devices(std::vector<device>()); }) == "clearance: devices, but not one of them");
  const std::string none =
      "clearance: there is no CUDA device " + std::to_string(there) + "; this process sees " + std::to_string(there);
  CHECK(refused([&] { devices{0, there}; }) == none);
  CHECK(refused([&] { devices(std::vector{device{there}}); }) == none);
  CHECK(refused([] { devices{-1}; }).find("no CUDA device -1") != std::string::npos);
  CHECK(devices::all().size() == std::size_t(there));
  const own_stream of_first;
  if (there > 1) {
    const std::string wrong = "clearance: the stream that was given for device 1 is not one of that device";
    CHECK(refused([&] { devices(std::vector{device{0, of_first.handle}, device{1, of_first.handle}}); }) == wrong);
  }
  CHECK(cudaGetLastError() == cudaSuccess);
  CHECK(current() == 0);

  const devices on{0, 0};
  const auto robot = robot_of(d, 2, 20);
  const auto poses = poses_of(d, 2);
  const auto cloud = d.points(1000, 2);
  const auto model = robot.on(on), on_three = robot.on(devices{0, 0, 0});
  const auto alone = robot.on(device{});
  CHECK(refused([&] { clearance::query(on, on_three, min_distance{}); }) ==
        "clearance: the robot is on 3 devices, but 2 are asked");
  if (there > 1)
    CHECK(refused([&] { clearance::query(devices{0, 1}, model, min_distance{}); }) ==
          "clearance: the robot is not on device 1, which is asked");
  counted_memory first, second;
  const std::vector<std::pmr::memory_resource*> both = {&first, &second};
  CHECK(refused([&] { clearance::query(on, model, min_distance{}, std::span(both).first(1)); }) ==
        "clearance: 1 memory resources for 2 devices");
  {
    clearance::query query(on, model, clearance::min_distance{}, both);
    const auto expected = ask(host{}, robot, poses, cloud, min_distance{});
    CHECK(same_result(query(poses, cloud), expected));
    CHECK((first.held > 500 * sizeof(vec3) && second.held > 500 * sizeof(vec3)));
    clearance::query per_part(on, model, min_distance_per_part{}, both);
    const auto each = ask(host{}, robot, poses, cloud, min_distance_per_part{});
    CHECK(same_result(per_part(poses, cloud).all, each.all));
    CHECK((first.held > 1000 * sizeof(vec3) && second.held > 1000 * sizeof(vec3)));
    const std::size_t asked = first.asked + second.asked;
    const auto three = clearance::shard(devices{0, 0, 0}, cloud);
    Eigen::Isometry3d skewed = poses[0];
    skewed.linear() *= 1.01;
    const std::vector<clearance::part_minimum> minima(3);
    for (int round = 0; round < 3; ++round) {
      CHECK(refused([&] { query(poses, three.view()); }) == "clearance: a cloud of 3 pieces for 2 devices");
      CHECK(refused([&] { query(std::span(poses).first(1), cloud); }).find("2 parts, but 1 poses") !=
            std::string::npos);
      CHECK(refused([&] { query(std::vector{skewed, poses[1]}, cloud); }).find("clearance: ") == 0);
      CHECK(refused([&] { query(poses, point_span(cloud), skewed); }).find("clearance: ") == 0);
      CHECK(refused([&] {
              query(poses, std::vector{placed{point_span(cloud), poses[0]}, placed{point_span(cloud), skewed}});
            }).find("clearance: ") == 0);
      CHECK(refused([&] { per_part(poses, three.view()); }) == "clearance: a cloud of 3 pieces for 2 devices");
      CHECK(refused([&] { per_part(std::span(poses).first(1), cloud); }).find("2 parts, but 1 poses") !=
            std::string::npos);
      CHECK(refused([&] {
              ask(device{}, alone, poses, cloud, clearance::part_witnesses{minima});
            }).find("room for 3 minima") != std::string::npos);
      CHECK(same_result(query(poses, cloud), expected));
      CHECK(same_result(per_part(poses, cloud).all, each.all));
    }
    CHECK(first.asked + second.asked == asked);
  }
  CHECK((first.held == 0 && second.held == 0));
}

namespace {

auto fields(const clearance::point_counts& c) { return std::tuple(c.seen, c.valid, std::span(c.dropped)); }
auto fields(const clearance::distance_certainty& c) {
  return std::tuple(c.error.here, c.error.per_metre, c.error.gap, c.slop);
}
auto fields(const clearance::zone& z) {
  return std::tie(z.points, z.nearest, z.nearest_cloud, z.nearest_point, z.first_cloud, z.first_point);
}
auto fields(const clearance::pair_distance& p) { return std::tie(p.cloud, p.point, p.part, p.primitive, p.distance); }
auto fields(const clearance::self_filter_counts& c) { return std::tie(c.points, c.own, c.uncertain); }
auto fields(const clearance::zones_result& r) {
  return std::tie(r.per_part, r.min_points, r.zones, r.counts, r.unseen);
}
auto fields(const clearance::within_result& r) { return std::tie(r.offsets, r.pairs, r.counts, r.certain); }
auto fields(const clearance::collision_result& r) { return std::tie(r.state, r.cloud, r.point, r.part, r.counts); }
auto fields(const clearance::point_distances& r) {
  return std::tie(r.distance, r.part, r.primitive, r.counts, r.certain);
}
auto fields(const clearance::part_distances& r) { return std::tie(r.distance, r.points, r.counts, r.certain); }
auto fields(const clearance::nearest_k_result& r) { return std::tie(r.per_part, r.pairs, r.counts, r.certain); }
auto fields(const clearance::self_filter_result& r) { return std::tie(r.labels, r.offsets, r.rest, r.counts); }
auto fields(const clearance::min_distances_result& r) { return std::tie(r.of); }
auto fields(const clearance::in_collisions_result& r) { return std::tie(r.of, r.counts); }
auto fields(const clearance::min_distances_per_part_result& r) { return std::tie(r.all, r.parts); }

/// Compares every field of two results, numbers by their bits.
template <class T>
bool same(const T& a, const T& b) {
  if constexpr (std::is_same_v<T, clearance::min_distance_result>)
    return same_result(a, b);
  else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
    return same_bytes(a, b);
  else if constexpr (requires { a.begin(); })
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) { return same(x, y); });
  else
    return std::apply(
        [&](const auto&... of_a) {
          return std::apply([&](const auto&... of_b) { return (same(of_a, of_b) && ...); }, fields(b));
        },
        fields(a));
}

/// Asks several devices and one: prepared, cold, warm and moved, and in one call. `alone` and `here` are for the one.
template <class Q, class There, class Alone, class Clouds, class Here>
void like_one(const devices& on, const There& there, const Alone& alone, std::vector<Eigen::Isometry3d> poses,
              const Clouds& clouds, const Here& here, const Q& q, verdict& v, const std::string& what) {
  clearance::query query(on, there, q);
  typename Q::result expected = ask(device{}, alone, poses, here, q);
  for (const char* when : {", cold", ", warm"})
    v.require(same(query(poses, clouds), expected), what, when, ": differs from one device's result");
  poses[0].translation().x() += 0.01, poses.back().translation().z() += 0.3;
  expected = ask(device{}, alone, poses, here, q);
  v.require(same(query(poses, clouds), expected), what, ", moved: differs from one device's result");
  v.require(same(ask(on, there, poses, clouds, q), expected), what, ", one call: differs from one device's result");
}

/// Two clouds, so that there are few points for some devices, or none.
struct two_given {
  std::string name;
  std::vector<vec3> first, second;
  Eigen::Isometry3d poses[2];

  std::vector<placed<point_span>> here() const {
    return {{point_span(first, {.farthest = 2.5f}), poses[0]}, {point_span(second), poses[1]}};
  }
};

std::vector<two_given> pairs_of_clouds(dice& d, std::size_t most) {
  std::vector<two_given> all;
  const auto add = [&](const std::string& name, std::vector<vec3> first, std::vector<vec3> second) {
    if (first.size() > 100) first[first.size() / 3].y = clearance::not_a_number;
    all.push_back({name, std::move(first), std::move(second), {d.pose(0.2), d.pose(0.2)}});
  };
  add("one of two is empty", d.points(most, 1.5), {});
  add("the first of two is empty", {}, d.points(most, 1.5));
  add("one of two is small", d.points(most, 1.5), d.points(3, 1));
  add("the first of two is a point", d.points(1, 0.5), d.points(most + 7, 1.5));
  add("both are small", d.points(2, 0.5), d.points(5, 0.5));
  add("both are empty", {}, {});
  add("many are equally near", std::vector<vec3>(501, vec3{0.7f, 0.2f, 0.1f}), d.points(9, 1.5));
  add("the errors of one are in all brackets", d.points(most, 1.5), d.points(2, 1));
  all.back().poses[1] = shifted(1e5, 0, 0);
  return all;
}

/// Asks about the same points in host memory; on their devices, in about equal shards; and in shards of which some are
/// empty.
template <class Q, class Model>
void like_one(const Model& robot, const std::vector<Eigen::Isometry3d>& poses, const std::vector<two_given>& given,
              const Q& q, verdict& v, const std::string& what) {
  const auto alone = robot.on(device{});
  for (const auto& [name, on] : all_devices()) {
    const auto there = robot.on(on);
    for (const two_given& two : given) {
      const auto here = two.here();
      const std::string which = what + ", " + two.name + ", on " + name;
      like_one(on, there, alone, poses, here, here, q, v, which);
      const auto first = clearance::shard(on, here[0].source), second = clearance::shard(on, here[1].source);
      const std::vector<placed<sharded<point_span>>> shards = {{first.view(), here[0].pose},
                                                               {second.view(), here[1].pose}};
      like_one(on, there, alone, poses, shards, here, q, v, which + ", in shards");
      std::vector<std::size_t> cuts(on.size() + 1, 1), none(on.size() + 1, 0);
      cuts[0] = 0, cuts.back() = none.back() = ~std::size_t(0);
      const cut_by_hand most_in_last(on, two.first, cuts), all_in_last(on, two.second, none);
      const std::vector<placed<point_span>> plain = {{point_span(two.first), two.poses[0]},
                                                     {point_span(two.second), two.poses[1]}};
      const std::vector<placed<sharded<point_span>>> unequal = {{most_in_last.view(), two.poses[0]},
                                                                {all_in_last.view(), two.poses[1]}};
      like_one(on, there, alone, poses, unequal, plain, q, v, which + ", in unequal shards");
    }
  }
}

/// Calls `ask(parts, each)` for a robot of few parts and one of many; `each(question, name)` asks about it.
template <class Ask>
void each_robot(unsigned seed, Ask ask) {
  dice d(seed);
  verdict v;
  for (const int parts : {3, 130}) {
    const auto robot = robot_of(d, parts, parts > 100 ? 5 : 60);
    const auto poses = poses_of(d, parts);
    auto given = pairs_of_clouds(d, 3001);
    if (parts > 100) given.resize(3);
    ask(parts, [&](const auto& q, const std::string& what) {
      like_one(robot, poses, given, q, v, what + ", " + std::to_string(parts) + " parts");
    });
  }
}

}  // namespace

TEST_CASE("Several devices say of pairs of points and parts what one says, in every bit", "[slow]") {
  each_robot(18, [](int parts, const auto& each) {
    std::vector<double> growing, radii, margins, paddings;
    for (int k = 0; k < parts; ++k) {
      growing.push_back(0.01 * k), growing.push_back(0.02 * k + 0.05);
      radii.push_back(0.3 / (k + 1)), margins.push_back(0.001 * k - 0.02), paddings.push_back(0.002 * (k % 9));
    }
    each(clearance::zones{.thresholds = {0, 0.05, 0.4}}, "zones");
    each(clearance::zones{.thresholds = growing, .each_part = true, .min_points = 3}, "zones of each part");
    each(clearance::within{{0.1}}, "within");
    each(clearance::within{radii}, "within, of each part");
    for (const double margin : {-0.05, 0.0, 0.05}) each(clearance::in_collision{{margin}}, "in_collision");
    each(clearance::in_collision{margins}, "in_collision, of each part");
    each(clearance::distances_per_part{}, "distances_per_part");
    each(clearance::distances_per_part{0.3}, "distances_per_part, near ones");
    each(clearance::self_filter{}, "self_filter");
    each(clearance::self_filter{paddings}, "self_filter, of each part");
  });
}

TEST_CASE("Several devices say of every point, and of the nearest, what one says, in every bit", "[slow]") {
  each_robot(19, [](int, const auto& each) {
    each(clearance::distances{.which = true}, "distances");
    each(clearance::distances{.d_max = 0.2, .which = true}, "distances, near ones");
    each(clearance::distances{.d_max = 0.2}, "distances alone");
    for (const std::size_t k : {1, 7, 400}) each(clearance::nearest_k{k}, "nearest_k");
    each(clearance::nearest_k{.k = 7, .d_max = 0.2}, "nearest_k, near ones");
  });
}

TEST_CASE("One device alone reads pieces wherever they lie: on other devices, and in host memory") {
  dice d(22);
  verdict v;
  const auto robot = robot_of(d, 3, 60);
  const auto poses = poses_of(d, 3);
  const auto points = d.points(3001, 1.5);
  const sharded<point_span> on_host(
      std::vector{point_span(points.data(), 1000), point_span(points.data() + 1000, 2001)});
  const clearance::distances q{.which = true};
  const auto expected = ask(host{}, robot, poses, points, q);
  for (const auto& [name, on] : all_devices()) {
    const auto shards = clearance::shard(on, points);
    for (const device& its : on.each()) {
      const auto alone = robot.on(its);
      v.require(same(ask(its, alone, poses, shards.view(), q), expected), "shards on ", name, ", read by ", its.id);
      v.require(same(ask(its, alone, poses, on_host, q), expected), "pieces in host memory, read by ", its.id);
    }
  }
}

TEST_CASE("Several devices say of many configurations what one says, in every bit", "[slow]") {
  dice d(20);
  verdict v;
  scene<inner_sphere> s;
  for (int part = 0; part < 3; ++part)
    s.parts.push_back(random_primitives<inner_sphere>(d, 40, 0.3, 0.05)), s.poses.push_back(d.pose(0.5));
  const auto robot = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const configurations poses = configurations_of(s, d, 9);
  const auto given = pairs_of_clouds(d, 3001);
  for (const double d_max : {double(clearance::infinity), 0.2}) {
    like_one(robot, poses, given, clearance::min_distances{d_max}, v, "min_distances");
    like_one(robot, poses, given, clearance::min_distances_per_part{d_max}, v, "min_distances_per_part");
  }
  for (const double margin : {-0.02, 0.0, 0.1})
    like_one(robot, poses, given, clearance::in_collisions{{margin}}, v, "in_collisions");
  like_one(robot, poses, given, clearance::in_collisions{{0.2, 0.0, 0.1}}, v, "in_collisions, of each part");
}

TEST_CASE("Several devices say how deep points are in solids as one says, in every bit") {
  dice d(21);
  verdict v;
  const auto [meshes, poses] = closed_scene(63);
  const auto robot = clearance::make_model<clearance::aabb>(meshes);
  auto given = pairs_of_clouds(d, 2001);
  given.push_back({"a crowd inside", d.points(4001, 0.4), d.points(3, 0.1), {d.pose(0.1), d.pose(0.1)}});
  for (const bool which : {true, false})
    for (const double d_max : {0.1, double(clearance::infinity)})
      like_one(robot, poses, given, clearance::signed_distances{d_max, which}, v, "signed_distances");
}

TEST_CASE("Of several devices one sees what is too close, and nothing is free; each pixel has its own distance") {
  verdict v;
  const auto robot = clearance::make_model<clearance::sphere>(ball_before_it);
  const auto alone = robot.on(device{});
  const std::vector<Eigen::Isometry3d> poses = {shifted(0, 0, 0)};
  for (const std::size_t near : {0, 1, 400}) {
    const too_close_frame frame(near, 50, 3);
    const std::tuple clouds(placed{frame.image(), shifted(0, 0, 0)}, placed{point_span(), shifted(0, 0, 0)});
    for (const auto& [name, on] : all_devices()) {
      const std::string what = std::to_string(near) + " too close, on " + name;
      const auto there = robot.on(on);
      const auto each = [&](const auto& q) { like_one(on, there, alone, poses, clouds, clouds, q, v, what); };
      each(clearance::in_collision{{0.1}});
      each(clearance::in_collisions{{0.1}});
      each(clearance::zones{.thresholds = {0.1, 0.4}});
      each(clearance::distances{.which = true});
      each(clearance::self_filter{});
      v.require(ask(on, there, poses, clouds, clearance::in_collision{{0.1}}).state ==
                    (near == 0 ? clearance::state::free : clearance::state::possible),
                what, ": another state");
    }
  }
}

}  // namespace devices_test
