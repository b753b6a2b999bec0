// SPDX-License-Identifier: BSD-3-Clause
// After its first calls a prepared question allocates nothing. Every way to get memory is counted, in the process and
// on the device, and so is every wait by the driver.
// wraps: cudaMalloc cudaMallocAsync cudaMallocHost cudaHostAlloc cudaMallocManaged cudaMallocFromPoolAsync cudaFree cudaFreeAsync
// wraps: cudaDeviceSynchronize cudaStreamSynchronize _Znwm
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/questions/collect.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

namespace allocation_test {

namespace {

std::size_t on_device = 0, waits = 0;
thread_local std::size_t on_host = 0;

}  // namespace

// The linker sends calls of the names above here.
#define COUNTED(counter, name, parameters, arguments) \
  cudaError_t __real_##name parameters;               \
  cudaError_t __wrap_##name parameters {              \
    ++counter;                                        \
    return __real_##name arguments;                   \
  }
extern "C" {
COUNTED(on_device, cudaMalloc, (void** p, std::size_t n), (p, n))
COUNTED(on_device, cudaMallocAsync, (void** p, std::size_t n, cudaStream_t s), (p, n, s))
COUNTED(on_device, cudaMallocHost, (void** p, std::size_t n), (p, n))
COUNTED(on_device, cudaHostAlloc, (void** p, std::size_t n, unsigned flags), (p, n, flags))
COUNTED(on_device, cudaMallocManaged, (void** p, std::size_t n, unsigned flags), (p, n, flags))
COUNTED(on_device, cudaMallocFromPoolAsync, (void** p, std::size_t n, cudaMemPool_t pool, cudaStream_t s),
        (p, n, pool, s))
COUNTED(on_device, cudaFree, (void* p), (p))
COUNTED(on_device, cudaFreeAsync, (void* p, cudaStream_t s), (p, s))
COUNTED(waits, cudaDeviceSynchronize, (), ())
COUNTED(waits, cudaStreamSynchronize, (cudaStream_t s), (s))

void* __real__Znwm(std::size_t n);  // operator new
void* __wrap__Znwm(std::size_t n) {
  ++on_host;
  return __real__Znwm(n);
}
}

using namespace testing;
using clearance::device, clearance::placed;

namespace {

struct counted {
  std::size_t before_on_device = on_device, before_waits = waits, before_on_host = on_host;
  bool nothing(bool also_on_host = true) const {
    return on_device == before_on_device && waits == before_waits && (!also_on_host || on_host == before_on_host);
  }
};

}  // namespace

TEST_CASE("What is counted is counted") {
  const counted before;
  const device gpu;
  const auto some = gpu.copy_in(std::span<const int>(std::vector<int>(10)));
  gpu.wait();
  CHECK((on_device > before.before_on_device && waits > before.before_waits && on_host > before.before_on_host));
}

TEST_CASE("Prepared questions allocate nothing, and do not wait, after their first frames") {
  const device gpu;
  const auto s = scenes<inner_sphere>()[1];
  const sources<inner_sphere> all(s);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{}).on(gpu);
  const auto points = gpu.copy_in(all.span.bytes()), pixels = gpu.copy_in(all.raw.bytes());
  const placed here{all.span, s.cloud_pose}, cloud{all.span.at(points.data()), s.cloud_pose};
  const std::tuple clouds{cloud, placed{all.raw.at(pixels.data()), all.camera_pose}};
  clearance::query query(gpu, model, clearance::min_distance{});
  clearance::query per_part(gpu, model, clearance::min_distance_per_part{});
  clearance::query enqueued(gpu, model, clearance::min_distance{});  // it is never waited for
  const clearance::devices twice{0, 0};
  const auto on_both = make_model<clearance::sphere>(s, {}, clearance::wrapped{}).on(twice);
  clearance::query together(twice, on_both, clearance::min_distance{});
  clearance::query together_per_part(twice, on_both, clearance::min_distance_per_part{});
  clearance::pointwise::device_points<typename decltype(model)::view_type> each(gpu, model.view());
  const clearance::device_buffer<clearance::min_distance_result> result(1, gpu.id);
  const clearance::device_buffer<clearance::part_minimum> there(model.size(), gpu.id);
  const clearance::device_buffer<clearance::world_transform> poses(s.poses.size(), gpu.id);
  const clearance::device_buffer<real> distance(all.span.size() + all.raw.size(), gpu.id);
  const clearance::device_buffer<clearance::point_counts> counts(1, gpu.id);
  const std::vector<clearance::world_transform> world(s.poses.begin(), s.poses.end());
  gpu.stage(std::span(world), poses.data());
  const auto frames = [&] {
    query(s.poses, cloud), query(s.poses, clouds), query(s.poses, here);  // the last from host memory
    per_part(s.poses, clouds);
    together(s.poses, clouds), together(s.poses, here);
    query.enqueue(s.poses, clouds, result.data()), enqueued.enqueue(s.poses, clouds, result.data());
    per_part.enqueue(s.poses, cloud, {result.data(), there.data()});
    query.enqueue(poses.data(), cloud.source, nullptr, result.data());
    per_part.enqueue(poses.data(), cloud.source, nullptr,
                     clearance::min_distance_per_part::out{result.data(), there.data()});
    each.enqueue(s.poses, clouds, {distance.data()}, 0.5f, counts.data(), clearance::frames::as_it_is{});
  };
  const auto of_several = [&] { together_per_part(s.poses, clouds); };  // its result has memory of its own
  frames(), frames(), of_several(), of_several();
  const counted before;
  for (int k = 0; k < 5; ++k) frames();
  CHECK(before.nothing());
  for (int k = 0; k < 5; ++k) of_several();
  CHECK(before.nothing(false));
  query.forget(), per_part.forget();
  const counted cold;
  frames();
  CHECK(cold.nothing());
  gpu.wait();
}

namespace {

/// What a frame asks, made before anything is counted.
struct pair_options {
  double near;
  clearance::zones zones = {.thresholds = {near, 2 * near}};
  clearance::within within = {.radius = {real(near)}};
  clearance::in_collision in_collision = {.margins = {near}};
  clearance::distances_per_part per_part = {.d_max = real(near)};
  clearance::self_filter own = {.padding = {near}};
};

/// Every prepared question about pairs, about one cloud and about so many.
void ask_about_pairs(const scene<inner_sphere>& s, std::size_t clouds) {
  const device gpu;
  const sources<inner_sphere> all(s);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{}).on(gpu);
  const auto points = gpu.copy_in(all.span.bytes());
  const placed cloud{all.span.at(points.data()), s.cloud_pose};
  const std::vector several(clouds, cloud);
  clearance::query zones(gpu, model, clearance::zones{{0.0}});
  clearance::query within(gpu, model, clearance::within{{0.0}});
  clearance::query in_collision(gpu, model, clearance::in_collision{});
  clearance::query per_part(gpu, model, clearance::distances_per_part{});
  clearance::query filter(gpu, model, clearance::self_filter{});
  clearance::query where(gpu, model, clearance::part_witnesses{});
  const clearance::device_buffer<clearance::part_minimum> minima(model.size(), gpu.id);
  const clearance::device_buffer<clearance::part_witness> witnesses(model.size(), gpu.id);
  const clearance::device_buffer<clearance::point_counts> counts(1, gpu.id);
  const clearance::device_buffer<clearance::zone> zone(2 * model.size(), gpu.id);
  const clearance::device_buffer<clearance::pair_distance> pairs(1000, gpu.id);
  const clearance::device_buffer<unsigned long long> count(1, gpu.id);
  const clearance::device_buffer<clearance::collision_result> result(1, gpu.id);
  const clearance::device_buffer<real> distance(clouds * all.span.size() * model.size(), gpu.id);
  const clearance::device_buffer<clearance::point_label> labels(clouds * all.span.size(), gpu.id);
  const clearance::device_buffer<clearance::self_filter_counts> own(1, gpu.id);
  const auto reaches = gpu.copy_in(std::span<const real>(std::vector<real>(model.size(), 0.2f)));
  const clearance::collect answer{
      clearance::pairwise::listed{pairs.data(), count.data(), pairs.size(), reaches.data()}};
  clearance::query collect(gpu, model, answer);
  const auto frame = [&](const auto& asked, const pair_options& now) {
    zones.enqueue(s.poses, asked, now.zones, {zone.data(), counts.data()});
    within.enqueue(s.poses, asked, now.within, {pairs.data(), pairs.size(), count.data(), counts.data()});
    in_collision.enqueue(s.poses, asked, now.in_collision, result.data());
    per_part.enqueue(s.poses, asked, now.per_part, {distance.data(), counts.data()});
    collect.enqueue(s.poses, asked, answer, {counts.data()});
    filter.enqueue(s.poses, asked, now.own, {labels.data(), own.data()});
    where.enqueue(s.poses, asked, {minima.data(), witnesses.data()});
  };
  gpu.stage(std::span<const clearance::part_minimum>(std::vector<clearance::part_minimum>(model.size())),
            minima.data());
  const pair_options each[] = {{0.1}, {0.2}, {0.3}};
  frame(several, each[0]);
  const counted before;
  for (const pair_options& now : each) frame(several, now), frame(cloud, now);
  CHECK(before.nothing());
  const auto waited_for = [&] {
    zones(s.poses, s.points, each[0].zones), within(s.poses, s.points, each[0].within);
    in_collision(s.poses, s.points, each[0].in_collision), per_part(s.poses, s.points, each[0].per_part);
    filter(s.poses, s.points, each[0].own);
  };
  waited_for();
  const std::size_t known = on_device;
  waited_for(), frame(several, each[0]), waited_for();
  CHECK(on_device == known);
  gpu.wait();
}

}  // namespace

TEST_CASE("Prepared questions about pairs allocate nothing, and do not wait, after a frame of a size") {
  ask_about_pairs(scenes<inner_sphere>()[1], 2);
  dice d(41);
  scene<inner_sphere> s;  // of more parts and clouds than travel with a launch
  for (int part = 0; part < 14; ++part)
    s.parts.push_back(random_primitives<inner_sphere>(d, 20, 0.2, 0.1)), s.poses.push_back(d.pose(1));
  s.points = d.points(2000, 2);
  ask_about_pairs(s, 5);
}

TEST_CASE("One call takes one block of memory in the order of its stream, and waits for nothing") {
  const device gpu;
  const auto s = scenes<inner_sphere>()[1];
  const sources<inner_sphere> all(s);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{}).on(gpu);
  const auto points = gpu.copy_in(all.span.bytes());
  const placed cloud{all.span.at(points.data()), s.cloud_pose};
  const clearance::device_buffer<clearance::min_distance_result> result(1, gpu.id);
  const auto ask = [&] { clearance::enqueue(gpu, model, s.poses, cloud, clearance::min_distance{}, result.data()); };
  ask();
  const counted before;
  ask();
  CHECK(on_device == before.before_on_device + 2);  // taken, and given back
  CHECK(waits == before.before_waits);
  const clearance::device_buffer<clearance::collision_result> found(1, gpu.id);
  const auto collide = [&] {
    clearance::enqueue(gpu, model, s.poses, cloud, clearance::in_collision{{0.1}}, found.data());
  };
  collide();
  const counted collided;
  collide();
  CHECK((on_device == collided.before_on_device + 2 && waits == collided.before_waits));
  gpu.wait();
}

}  // namespace allocation_test
