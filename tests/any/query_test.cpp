// SPDX-License-Identifier: BSD-3-Clause
// A question behind an interface answers as the library's query does, about robots and clouds of any kind.
#include "solid/shapes.hpp"
#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/same_answer.hpp"

#include <clearance/any/query.hpp>
#include <clearance/points/strided_points.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/solid/close_mesh.hpp>

namespace any_query_test {

using namespace testing;
using namespace clearance;

namespace {

using cloud = any::cloud<point_span, strided_points<double>>;
using either = any::uncertain_too<cloud>;

const auto spheres = std::make_shared<const any::model<>>(
    model{std::vector{make_part<sphere>(std::vector{inner_sphere{{0, 0, 0}, 0.3f}}),
                      make_part<sphere>(std::vector{inner_sphere{{0.5f, 0, 0}, 0.1f}})}});
const std::vector poses(2, Eigen::Isometry3d::Identity());

struct scene {
  std::vector<vec3> points = dice(3).points(1000, 2);
  std::vector<double> doubles;
  std::vector<cloud> clouds;

  scene() {
    for (const vec3 p : points) doubles.insert(doubles.end(), {double(p.x), double(p.y), double(p.z) + 0.25});
    strided_points<double> records;
    records.data = reinterpret_cast<const std::byte*>(doubles.data()), records.count = points.size(), records.step = 24;
    records.offset[1] = 8, records.offset[2] = 16;
    Eigen::Isometry3d turned(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
    clouds = {placed{point_span(points)}, placed{records, turned}};
  }
};

template <class Cloud, class Q>
void check(const Q& q, const std::vector<Cloud>& clouds, const any::model<>& robot = *spheres) {
  const auto trees = std::make_shared<const any::model<>>(robot);
  const auto asked = any::prepare<any::query<Q, Cloud>>(host{}, trees, q);
  std::visit(
      [&](const auto& its) {
        if constexpr (any::is_about<Q, std::remove_cvref_t<decltype(its)>>()) {
          const std::span<const Eigen::Isometry3d> at(poses.data(), its.size());
          const auto typed = ask(host{}, its, at, clouds, q);
          CHECK(same_answer((*asked)(at, clouds, q), typed));
          CHECK(same_answer((*asked)(at, clouds, q), typed));  // after a frame
          asked->forget();
          CHECK(same_answer((*asked)(at, clouds, q), typed));
        }
      },
      *trees);
}

}  // namespace

TEST_CASE("A question behind an interface has the bits of the library's query") {
  const scene s;
  check(min_distance_per_part{}, s.clouds);
  const triangle_model<> box = make_model<obb>(std::vector{close_mesh(shapes::box({0, 0, 0}, {0.3, 0.2, 0.1}))});
  check(signed_distances{}, s.clouds, box);
  std::vector<either> unsure;
  for_each_cloud(s.clouds, [&](const auto& source, const Eigen::Isometry3d& pose) {
    any_noise noise;
    noise.kind = noise_kind::lidar, noise.lidar = {0.01f, 0.001f};
    if (unsure.size() == 1)
      unsure.push_back(placed{source, pose});
    else
      unsure.push_back(placed{uncertain(source, noise, {.shift = 0.003}), pose});
  });
  check(zones{{0.2, 0.7}}, unsure);
  check(certain_distance{}, unsure);
}

TEST_CASE("A question behind an interface says what is known when its time is over") {
  const scene s;
  const auto asked = any::prepare<any::timed_query<min_distance_per_part, cloud>, any::timed>(host{}, spheres, {});
  const auto all = asked->by(std::chrono::hours(1), poses, s.clouds, {});
  CHECK(all.unseen == 0);
  CHECK(same_answer(all.result, (*asked)(poses, s.clouds, {})));
  const auto none_of_it = asked->by(std::chrono::seconds(0), poses, s.clouds, {});
  CHECK(none_of_it.unseen == count_points(s.clouds));
  CHECK(none_of_it.result.all.state != state::free);
}

TEST_CASE("A question that is not about such a robot is refused, and so is what clearance::query refuses") {
  using signed_query = any::query<signed_distances, cloud>;
  CHECK_THROWS_WITH(any::prepare<signed_query>(host{}, spheres, {}),
                    "clearance: this question is about robots of triangles");
  using zones_query = any::query<zones, cloud>;
  CHECK_THROWS_AS(any::prepare<zones_query>(host{}, spheres, zones{{-1}}), std::invalid_argument);
}

}  // namespace any_query_test
