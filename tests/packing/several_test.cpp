// SPDX-License-Identifier: BSD-3-Clause
#include "packing/packers.hpp"

#include <clearance/packing/pack.hpp>
#include <clearance/solid/implicit.hpp>

#include <atomic>
#include <ranges>
#include <thread>

namespace several_test {

using namespace packer_laws;

namespace {

std::vector<triangle_mesh> some_meshes() {
  using namespace shapes;
  return {box({0, 0, 0}, {1, 1, 1}), globe({5, -3, 2}, 0.02),
          merged(box({0, 0, 0}, {1, 0.7, 0.9}), globe({1, 0.5, 0.5}, 0.4)), box({0, 0, 0}, {1, 1, 0.01}),
          torus(1, 0.25)};
}

bool all_same(const std::vector<packing>& a, const std::vector<packing>& b) {
  return std::ranges::equal(a, b, [](const packing& x, const packing& y) { return same(x, y); });
}

/// Says whether two calls were ever under way at the same time.
struct one_at_a_time {
  std::atomic<int> inside = 0, broken = 0, calls = 0;
  void operator()() {
    broken += ++inside != 1;
    ++calls;
    std::this_thread::yield();
    --inside;
  }
};

struct named_mesh {
  std::string name;
  triangle_mesh mesh;
};

}  // namespace

TEST_CASE("several are packed as one by one, whatever they come in, on any number of threads") {
  const auto meshes = some_meshes();
  std::vector<packing> alone;
  std::vector<mesh_solid> solids;
  std::vector<named_mesh> named;
  for (const auto& mesh : meshes) {
    alone.push_back(pack(mesh, {.count = 150, .seed = 1}));
    solids.emplace_back(mesh);
    named.push_back({"a", mesh});
  }
  for (const unsigned threads : {0, 1, 2, 5}) {
    CHECK(all_same(pack(meshes, {.count = 150, .seed = 1, .threads = threads}), alone));
    CHECK(all_same(pack(solids, {.count = 150, .seed = 1, .threads = threads}), alone));
  }
  CHECK(all_same(pack(named | std::views::transform(&named_mesh::mesh), {.count = 150, .seed = 1}), alone));
  const auto closed = [](const named_mesh& each) { return mesh_solid(each.mesh); };  // made by the thread that packs it
  CHECK(all_same(pack(named | std::views::transform(closed), {.count = 150, .seed = 1}), alone));
  CHECK(pack(std::vector<triangle_mesh>{}).empty());
}

TEST_CASE("the first of several that is wrong is named, with its own words") {
  auto meshes = some_meshes();
  meshes.insert(meshes.begin() + 1, shapes::moebius());
  meshes.push_back(triangle_mesh{});
  std::string alone;
  try {
    pack(shapes::moebius());
  } catch (const std::invalid_argument& error) {
    alone = error.what();
  }
  for (const unsigned threads : {0, 1}) {
    std::size_t index = meshes.size();
    std::string why;
    try {
      pack(meshes, {.count = 5, .threads = threads});
    } catch (const solid_error& error) {
      index = error.index, why = error.what();
    }
    CHECK(index == 1);
    CHECK(!why.empty());
    CHECK(why == alone);
  }
  CHECK_THROWS_AS(pack(some_meshes(), {.gap_target = -1}), solid_error);
  struct mine {};
  CHECK_THROWS_AS(pack(some_meshes(), {.progress = [](std::size_t, std::size_t) { throw mine(); }}), mine);
}

TEST_CASE("one that is wrong stops the others") {
  std::vector<triangle_mesh> meshes(4, shapes::box({0, 0, 0}, {1, 1, 1}));
  meshes.front() = shapes::moebius();
  // Without an end to the others this case would take hours.
  CHECK_THROWS_AS(pack(meshes, {.count = 100000000, .threads = 2}), solid_error);
}

TEST_CASE("of several the progress is that of all, told by one thread at a time") {
  const auto meshes = some_meshes();
  one_at_a_time calls;
  std::size_t last = 0, most = 0;
  int backwards = 0, other_totals = 0;
  pack(meshes, {.count = 100, .progress = [&](std::size_t done, std::size_t of) {
                  calls();
                  backwards += done < last;
                  other_totals += of != 100 * meshes.size();
                  last = done, most = std::max(most, done);
                }});
  CHECK(calls.broken == 0);
  CHECK(backwards == 0);
  CHECK(other_totals == 0);
  CHECK(most > 100 * (meshes.size() - 1));  // the finished ones count as done
  CHECK(most <= 100 * meshes.size());
}

TEST_CASE("cancelling several stops all of them") {
  const std::vector<triangle_mesh> meshes(4, shapes::box({0, 0, 0}, {1, 1, 1}));
  one_at_a_time calls;
  // It says so once only: that is enough.
  const auto cancelled = [&] { return calls(), calls.calls == 200; };
  const auto packings = pack(meshes, {.count = 100000000, .cancelled = cancelled});
  CHECK(calls.broken == 0);
  REQUIRE(packings.size() == 4);
  std::size_t spheres = 0;
  for (const packing& p : packings) {
    CHECK(p.stopped_by == pack_stop::cancelled);
    if (!p.spheres.empty()) check_laws(meshes[0], p, 200);
    spheres += p.spheres.size();
  }
  CHECK(spheres > 0);
}

TEST_CASE("on one thread several are packed by the caller's alone") {
  std::atomic<int> strangers = 0, asked = 0;
  const auto caller = std::this_thread::get_id();
  const auto ball = [&](const Vector3d& p) {
    ++asked;
    if (std::this_thread::get_id() != caller) ++strangers;
    return p.norm() - 1;
  };
  const Eigen::AlignedBox3d around(Vector3d(-1, -1, -1), Vector3d(1, 1, 1));
  const std::vector solids(3, implicit_solid(ball, around));
  const auto packings = pack(solids, {.count = 4, .smallest_radius = 0.05, .threads = 1, .gap_tolerance = 0.5});
  CHECK(packings.size() == 3);
  CHECK(asked > 0);
  CHECK(strangers == 0);
}

TEST_CASE("a packing ends although the task that asked for it is cancelled") {
  const auto meshes = some_meshes();
  const packing alone = pack(meshes[0], {.count = 100});
  packing one;
  std::vector<packing> several;
  tbb::task_group_context caller;
  tbb::parallel_for(
      0, 1,
      [&](int) {
        caller.cancel_group_execution();
        one = pack(meshes[0], {.count = 100});
        several = pack(meshes, {.count = 100});
      },
      tbb::simple_partitioner{}, caller);
  CHECK(same(one, alone));
  REQUIRE(several.size() == meshes.size());
  CHECK(same(several[0], alone));
}

}  // namespace several_test
