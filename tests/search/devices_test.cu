// SPDX-License-Identifier: BSD-3-Clause
// Several devices together give the host's answer, in every bit. One GPU is named more than once, as are several of
// them; if there are two, both are asked, and the second alone.
#include "support/held_stream.cuh"
#include "support/product_device.cuh"

#include <clearance/make_model.hpp>
#include <clearance/device.cuh>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace devices_test {

using namespace testing;
using clearance::device, clearance::devices, clearance::host, clearance::min_distance, clearance::placed,
    clearance::point_span, clearance::sharded;

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

bool same_minimum(const clearance::part_minimum& a, const clearance::part_minimum& b) {
  return same_bits(a.distance, b.distance) && a.cloud == b.cloud && a.point == b.point && a.primitive == b.primitive;
}

/// Cold, warm, moved and moved back; one call, and every part's minimum. `clouds` is for the devices, `same` for the
/// host.
template <class Model, class Clouds, class Same>
void ask_often(const devices& on, const Model& on_host, std::vector<Eigen::Isometry3d> poses, const Clouds& clouds,
               const Same& same, verdict& v, const std::string& what) {
  const auto model = on_host.on(on);
  clearance::query query(on, model, clearance::min_distance{});
  const auto ask = [&](const std::string& when) {
    const auto expected = ask(host{}, on_host, poses, same, min_distance{});
    v.require(same_result(query(poses, clouds), expected), what, ", ", when, ": differs from the host's result");
    const auto [robot, each] = clearance::ask(host{}, on_host, poses, same, clearance::min_distance_per_part{});
    std::vector<clearance::part_minimum> minima(poses.size());
    v.require(same_result(query.per_part(poses, clouds, minima), robot), what, ", ", when,
              ": differs from the host's result by parts");
    v.require(std::ranges::equal(minima, each, same_minimum), what, ", ", when, ": some part's minimum differs");
  };
  ask("cold");
  ask("warm");
  poses[0].translation().x() += 0.01;
  ask("moved a little");
  poses.back().translation().z() -= 5;
  ask("moved far");
  query.forget();
  ask("cold again");
  v.require(same_result(ask(on, model, poses, clouds, min_distance{}), ask(host{}, on_host, poses, same, min_distance{})), what,
            ": one call differs");
  const auto [robot, each] = clearance::ask(on, model, poses, clouds, clearance::min_distance_per_part{});
  const auto [expected, its] = clearance::ask(host{}, on_host, poses, same, clearance::min_distance_per_part{});
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

clearance::triangle_mesh box(double half) {
  clearance::triangle_mesh m;
  for (int k = 0; k < 8; ++k) m.vertices.emplace_back(k & 1 ? half : -half, k & 2 ? half : -half, k & 4 ? half : -half);
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
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
  std::vector<decltype(clearance::make_part<clearance::aabb>(clearance::close_mesh(box(1))))> parts;
  for (const double half : {0.2, 0.3, 0.1})
    parts.push_back(clearance::make_part<clearance::aabb>(clearance::close_mesh(box(half)), {.tolerance = 1e-4}));
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
  CHECK(same_result(query(poses, point_span(there.data(), there.size())), ask(host{}, robot, poses, points, min_distance{})));
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

class counting_resource : public std::pmr::memory_resource {
 public:
  std::size_t asked = 0, held = 0;

 private:
  void* do_allocate(std::size_t bytes, std::size_t) override {
    void* p = nullptr;
    check(cudaMalloc(&p, bytes));
    ++asked, held += bytes;
    return p;
  }
  void do_deallocate(void* p, std::size_t bytes, std::size_t) override { cudaFree(p), held -= bytes; }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }
};

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
  CHECK(refused([&] { clearance::min_distance_query(on, on_three); }) ==
        "clearance: the robot is on 3 devices, but 2 are asked");
  if (there > 1)
    CHECK(refused([&] { clearance::min_distance_query(devices{0, 1}, model); }) ==
          "clearance: the robot is not on device 1, which is asked");
  counting_resource first, second;
  const std::vector<std::pmr::memory_resource*> both = {&first, &second};
  CHECK(refused([&] { clearance::min_distance_query(on, model, std::span(both).first(1)); }) ==
        "clearance: 1 memory resources for 2 devices");
  {
    clearance::query query(on, model, clearance::min_distance{}, both);
    const auto expected = ask(host{}, robot, poses, cloud, min_distance{});
    CHECK(same_result(query(poses, cloud), expected));
    CHECK((first.held > 500 * sizeof(vec3) && second.held > 500 * sizeof(vec3)));
    const std::size_t asked = first.asked + second.asked;
    const auto three = clearance::shard(devices{0, 0, 0}, cloud);
    Eigen::Isometry3d skewed = poses[0];
    skewed.linear() *= 1.01;
    std::vector<clearance::part_minimum> minima(3);
    for (int round = 0; round < 3; ++round) {
      CHECK(refused([&] { query(poses, three.view()); }) == "clearance: a cloud of 3 pieces for 2 devices");
      CHECK(refused([&] { query(std::span(poses).first(1), cloud); }).find("2 parts, but 1 poses") !=
            std::string::npos);
      CHECK(refused([&] { query(std::vector{skewed, poses[1]}, cloud); }).find("clearance: ") == 0);
      CHECK(refused([&] { query(poses, point_span(cloud), skewed); }).find("clearance: ") == 0);
      CHECK(refused([&] {
              query(poses, std::vector{placed{point_span(cloud), poses[0]}, placed{point_span(cloud), skewed}});
            }).find("clearance: ") == 0);
      CHECK(refused([&] { query.per_part(poses, cloud, minima); }).find("room for 3 minima") != std::string::npos);
      CHECK(same_result(query(poses, cloud), expected));
    }
    CHECK(first.asked + second.asked == asked);
  }
  CHECK((first.held == 0 && second.held == 0));
}

}  // namespace devices_test
