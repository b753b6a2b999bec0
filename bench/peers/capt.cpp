// SPDX-License-Identifier: BSD-3-Clause
// VAMP's CAPT on the same frame: is any sphere of a robot within a margin of any point, for 1,000 random
// configurations? It answers yes or no; ours says how near, and at which point of which part. CAPT is built for each
// frame, for radii up to the robot's largest; VAMP thins clouds before. `hits` is how many each finds; `missed` is how
// many CAPT calls free although a point is within the margin by more than rounding.
#include "min_distance/configurations.hpp"

#include <clearance/questions/min_distances.hpp>
#include <clearance/volume/sphere.hpp>

#include <vamp/collision/capt.hh>
#include <vamp/collision/filter.hh>

#include <benchmark/benchmark.h>

namespace {

using point = vamp::collision::Point;
using lanes = vamp::FloatVector<>;
using vamp::collision::CAPT;

constexpr std::size_t configurations = 1000;

/// `count` spheres per link: 40 or 2,048.
const std::vector<clearance::packing>& packings(std::int64_t count) {
  static const auto few = clearance::pack(bench::the_scene().meshes, {.count = 40});
  return count == 40 ? few : bench::the_scene().packings;
}
const std::vector<Eigen::Isometry3d>& poses() {
  static const auto all = bench::random_configurations(configurations);
  return all;
}

/// The links' spheres as the peer needs them: a vector per coordinate, and the facts about all radii.
class sphere_robot {
 public:
  sphere_robot(const std::vector<clearance::packing>& all, float margin) {
    for (const auto& packing : all) {
      links_.emplace_back();
      for (std::size_t k = 0; k < packing.spheres.size(); k += lanes::num_scalars) {
        std::array<std::array<float, lanes::num_scalars>, 4> rows;
        for (std::size_t lane = 0; lane < lanes::num_scalars; ++lane) {
          const auto& s =
              packing.spheres[std::min(k + lane, packing.spheres.size() - 1)];  // the last one fills up the vector
          rows[0][lane] = s.center.x, rows[1][lane] = s.center.y, rows[2][lane] = s.center.z,
          rows[3][lane] = s.radius + margin;
          largest = std::max(largest, s.radius + margin), least = std::min(least, s.radius + margin);
        }
        links_.back().push_back({lanes(rows[0]), lanes(rows[1]), lanes(rows[2]), lanes(rows[3])});
      }
    }
  }

  bool collides(const CAPT& cloud, std::span<const Eigen::Isometry3d> poses,
                const Eigen::Isometry3d& camera_from_world) const {
    for (std::size_t link = 0; link < links_.size(); ++link) {
      const Eigen::Matrix<float, 3, 4> m = (camera_from_world * poses[link]).matrix().topRows<3>().cast<float>();
      const auto row = [&](int r, const eight& s) { return s.x * m(r, 0) + s.y * m(r, 1) + s.z * m(r, 2) + m(r, 3); };
      for (const eight& s : links_[link])
        if (cloud.collides_simd({row(0, s), row(1, s), row(2, s)}, s.radius)) return true;
    }
    return false;
  }
  float least = clearance::infinity, largest = 0;

 private:
  struct eight {
    lanes x, y, z, radius;
  };
  std::vector<std::vector<eight>> links_;
};

/// The question of a row.
struct question {
  explicit question(const benchmark::State& state)
      : packings(::packings(state.range(0))),
        margin(1e-3f * float(state.range(1))),
        apart(1e-3f * float(state.range(2))),
        threads(unsigned(state.range(3))) {}
  const std::vector<clearance::packing>& packings;
  float margin, apart;  ///< Metres. Of points closer together than `apart` some are dropped, before either is asked.
  unsigned threads;
};

/// The frame's valid points, thinned by the peer's own filter unless `apart` is 0.
std::vector<point> points(float apart) {
  std::vector<point> all;
  for (const auto& p : bench::the_scene().cloud)
    if (clearance::is_finite(p)) all.push_back({p.x, p.y, p.z});
  return apart > 0
             ? vamp::collision::filter_pointcloud(all, apart, 20.f, {0, 0, 0}, {-20, -20, -20}, {20, 20, 20}, false)
             : all;
}

double milliseconds() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

clearance::min_distances_result distances(const question& asked, std::span<const clearance::vec3> cloud) {
  static const auto few = clearance::make_model<clearance::sphere>(::packings(40)),
                    many = clearance::make_model<clearance::sphere>(::packings(2048));
  return clearance::ask(clearance::host{.threads = asked.threads},
                        asked.packings.data() == ::packings(40).data() ? few : many, poses(),
                        clearance::placed{clearance::point_span(cloud), bench::the_scene().world_from_camera},
                        clearance::min_distances{asked.margin});
}
std::vector<clearance::vec3> as_ours(const std::vector<point>& cloud) {
  std::vector<clearance::vec3> all;
  for (const point& p : cloud) all.push_back({p[0], p[1], p[2]});
  return all;
}

void capt(benchmark::State& state) {
  const question asked(state);
  const sphere_robot robot(asked.packings, asked.margin);
  const std::size_t links = asked.packings.size();
  const Eigen::Isometry3d camera_from_world = bench::the_scene().world_from_camera.inverse();
  const auto& all = poses();
  clearance::host_workers workers(clearance::host{.threads = asked.threads});
  std::vector<char> hit(configurations);
  std::vector<point> cloud;
  double thinned = 0, built = 0;
  for (auto _ : state) {
    const double start = milliseconds();
    cloud = points(asked.apart);
    const double begin = milliseconds();
    const CAPT tree(cloud, robot.least, robot.largest, 0);
    thinned += begin - start, built += milliseconds() - begin;
    workers.for_pieces(configurations, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c)
        hit[c] = robot.collides(tree, std::span(all).subspan(c * links, links), camera_from_world);
    });
  }
  const auto exact = distances(asked, as_ours(cloud));
  double missed = 0;
  for (std::size_t c = 0; c < configurations; ++c) missed += !hit[c] && exact.of[c].distance < asked.margin - 1e-5f;
  state.counters["hits"] = double(std::ranges::count(hit, true)), state.counters["points"] = double(cloud.size());
  state.counters["missed"] = missed;
  state.counters["thin_ms"] = benchmark::Counter(thinned, benchmark::Counter::kAvgIterations);
  state.counters["build_ms"] = benchmark::Counter(built, benchmark::Counter::kAvgIterations);
}

void ours(benchmark::State& state) {
  const question asked(state);
  clearance::min_distances_result found = distances(asked, bench::the_scene().cloud);
  std::vector<clearance::vec3> few;
  double thinned = 0;
  for (auto _ : state) {
    const double start = milliseconds();
    if (asked.apart > 0) few = as_ours(points(asked.apart));
    thinned += milliseconds() - start;
    found = distances(asked, asked.apart > 0 ? few : bench::the_scene().cloud);
  }
  if (asked.apart > 0) state.counters["thin_ms"] = benchmark::Counter(thinned, benchmark::Counter::kAvgIterations);
  state.counters["hits"] =
      double(std::ranges::count_if(found.of, [](const auto& r) { return r.part != clearance::none; }));
  state.counters["points"] = double(found.of[0].valid);
}

#define SHOWN                                                 \
  ->ArgNames({"spheres", "margin_mm", "apart_mm", "threads"}) \
      ->MeasureProcessCPUTime()                               \
      ->UseRealTime()                                         \
      ->Unit(benchmark::kMillisecond)
BENCHMARK(ours)
    ->ArgsProduct({{40, 2048}, {0, 20}, {0, 10, 20}, {1}})
    ->ArgsProduct({{40, 2048}, {0, 20}, {0}, {2}}) SHOWN;
BENCHMARK(capt)->ArgsProduct({{40, 2048}, {0, 20}, {10, 20}, {1}})->ArgsProduct({{40, 2048}, {0, 20}, {20}, {2}}) SHOWN;
BENCHMARK(capt)->ArgsProduct({{40, 2048}, {0}, {0}, {1}})->Iterations(1) SHOWN;  // each a quarter of a minute, and 8 GB

}  // namespace

BENCHMARK_MAIN();
