// SPDX-License-Identifier: BSD-3-Clause
// With any number of ranks, each rank gets the answer of one process, in every bit.
#include "solid/shapes.hpp"
#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/make_model.hpp>
#include <clearance/mpi/shard.hpp>
#include <clearance/points/sharded.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/solid/mesh_solid.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace shard_test {

using namespace testing;
using clearance::host, clearance::in_collision, clearance::min_distance, clearance::min_distance_per_part,
    clearance::part_minimum, clearance::placed, clearance::point_span, clearance::slice;
namespace mpi = clearance::mpi;

// As MPI does in a communicator that returns its errors.
bool gathering_fails = false, sending_fails = false;
// A rank that is killed while all others wait for it.
bool gathering_kills = false;
extern "C" int MPI_Allgather(const void* from, int n, MPI_Datatype type, void* to, int m, MPI_Datatype their,
                             MPI_Comm comm) {
  if (gathering_kills) std::raise(SIGKILL);
  return gathering_fails ? MPI_ERR_OTHER : PMPI_Allgather(from, n, type, to, m, their, comm);
}
extern "C" int MPI_Bcast(void* data, int n, MPI_Datatype type, int by, MPI_Comm comm) {
  return sending_fails ? MPI_ERR_OTHER : PMPI_Bcast(data, n, type, by, comm);
}

namespace {

/// Catch2's own main runs in between.
const struct mpi_program {
  mpi_program() { MPI_Init(nullptr, nullptr); }
  ~mpi_program() { MPI_Finalize(); }
} program;

int rank() {
  int r = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &r);
  return r;
}
int ranks() {
  int n = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}
const mpi::shard on{MPI_COMM_WORLD, host{1}};

/// A cloud that on one rank cannot even say how large it is.
struct unplugged {
  point_span points;
  bool here;

  std::size_t size() const {
    if (here) throw std::runtime_error("clearance: the camera is unplugged");
    return points.size();
  }
  clearance::sample operator[](std::size_t i) const { return points[i]; }
};
template <class F>
std::string refused(F f) {
  try {
    f();
  } catch (const std::exception& e) {
    return e.what();
  }
  return {};
}

/// `mine` is this rank's piece of `whole`.
template <class Model, class Mine, class Whole>
void ask_often(const Model& model, std::vector<Eigen::Isometry3d> poses, const Mine& mine, const Whole& whole,
               verdict& v, const std::string& what) {
  clearance::query query(on, model, min_distance{});
  clearance::query per_part(on, model, min_distance_per_part{});
  for (int round = 0; round < 3; ++round) {
    const auto expected = ask(host{1}, model, poses, whole, min_distance{});
    v.require(same_result(query(poses, mine), expected), what, ", round ", round, ": another answer");
    v.require(same_result(ask(on, model, poses, mine, min_distance{}), expected), what, ", round ", round,
              ": another answer of one call");
    const auto [robot, each] = ask(host{1}, model, poses, whole, min_distance_per_part{});
    const auto [prepared, minima] = per_part(poses, mine);
    v.require(same_result(prepared, robot), what, ", round ", round, ": another answer by parts");
    v.require(std::ranges::equal(minima, each, same_minimum), what, ", round ", round, ": some part's minimum differs");
    const auto [again, theirs] = ask(on, model, poses, mine, min_distance_per_part{});
    v.require(same_result(again, robot) && std::ranges::equal(theirs, each, same_minimum), what, ", round ", round,
              ": one call differs by parts");
    poses[0].translation().x() += 0.1;
  }
}

}  // namespace

TEST_CASE("Ranks have the answer of one process: all scenes, points and images, in equal pieces") {
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const sources<inner_sphere> all(s);
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto piece = [&](const auto& source, const Eigen::Isometry3d& pose) {
      return placed{piece_of(source, std::size_t(rank()), std::size_t(ranks())), pose};
    };
    ask_often(model, s.poses, piece(all.span, s.cloud_pose), placed{all.span, s.cloud_pose}, v, s.name + ", points");
    ask_often(model, s.poses, piece(all.raw, all.camera_pose), placed{all.raw, all.camera_pose}, v, s.name + ", image");
    // Two clouds: the lowest cloud wins, on whatever rank it is.
    ask_often(
        model, s.poses,
        std::tuple(piece(all.span, s.cloud_pose), piece(all.span, s.cloud_pose), piece(all.raw, all.camera_pose)),
        std::tuple(placed{all.span, s.cloud_pose}, placed{all.span, s.cloud_pose}, placed{all.raw, all.camera_pose}), v,
        s.name + ", three clouds");
  }
}

TEST_CASE("Unequal pieces, empty ones, and points inside, which are nearest and certain on different ranks") {
  verdict v;
  dice d(17);
  const auto box = shapes::cube(0.3);
  std::vector<decltype(clearance::make_part<clearance::aabb>(clearance::close_mesh(box)))> boxes;
  for (const double tolerance : {1e-4, 0.05})
    boxes.push_back(clearance::make_part<clearance::aabb>(clearance::close_mesh(box), {.tolerance = tolerance}));
  const clearance::model solid(std::move(boxes));
  using part = clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>;
  std::vector<part> tolerant;
  for (const double tolerance : {0.09, 1e-4})
    tolerant.push_back(clearance::make_part(
        clearance::build<clearance::sphere>(random_primitives<inner_sphere>(d, 30, 0.3, 0.1)), 0, tolerance));
  const clearance::model spheres(std::move(tolerant));
  const std::vector<Eigen::Isometry3d> poses = {shifted(0, 0, 0), shifted(0.7, 0, 0)};
  for (const std::size_t n : {0, 1, 2, 7, 1001})
    for (const double half : {0.2, 0.6, 2.0}) {
      const auto points = d.points(n, half);
      for (int turn = 0; turn < 3; ++turn) {  // all to one rank; nothing to the first; all but one to the last
        const auto cut = [&](int k) -> std::size_t {
          if (k <= 0) return 0;
          if (k >= ranks()) return n;
          return turn == 0   ? n
                 : turn == 1 ? n * std::size_t(k - 1) / std::size_t(ranks())
                             : std::min<std::size_t>(n, 1);
        };
        const point_span whole(points), mine = whole.slice(cut(rank()), cut(rank() + 1));
        const std::string what =
            std::to_string(n) + " within " + std::to_string(half) + ", turn " + std::to_string(turn);
        ask_often(solid, poses, mine, whole, v, what + ", solid");
        ask_often(spheres, poses, mine, whole, v, what + ", spheres");
      }
    }
}

TEST_CASE("A rank that throws ends all with its sentence, and all can ask again") {
  dice d(4);
  const auto model = clearance::make_model<clearance::sphere>(
      std::vector<std::vector<inner_sphere>>{random_primitives<inner_sphere>(d, 30, 0.3, 0.1)});
  const auto points = d.points(500, 2);
  const std::vector<Eigen::Isometry3d> poses = {shifted(0, 0, 0)};
  clearance::query query(on, model, min_distance{});
  const int last = ranks() - 1;
  const auto mine = piece_of(point_span(points), std::size_t(rank()), std::size_t(ranks()));
  const auto expected = ask(host{1}, model, poses, points, min_distance{});

  mpi::together asked(MPI_COMM_WORLD);
  asked.agree(1, poses, mine);
  asked.attempt([&] {
    if (rank() == last) throw std::invalid_argument("clearance: the disk is full");
  });
  clearance::detail::joined_of<min_distance, decltype(model)::view_type> joined({}, {});
  const std::string told = refused([&] { asked.join(joined, clearance::min_distance_result{}); });
  if (rank() == last)
    CHECK(told == "clearance: the disk is full");
  else
    CHECK(told == "clearance: rank " + std::to_string(last) + " of " + std::to_string(ranks()) +
                      ": clearance: the disk is full");
  CHECK(same_result(query(poses, mine), expected));

  Eigen::Isometry3d skewed = poses[0];
  skewed.linear() *= 1.01;
  CHECK(refused([&] { query(std::vector{skewed}, mine); }).find("clearance: ") == 0);  // on every rank, by itself
  CHECK(same_result(query(poses, mine), expected));
  if (ranks() > 1) {
    const std::vector<Eigen::Isometry3d> other = {shifted(rank() == last ? 1e-9 : 0, 0, 0)};
    CHECK(refused([&] { query(other, mine); }) ==
          "clearance: rank " + std::to_string(last) + " asks about other poses than rank 0");
    for (int axis = 0; axis < 3; ++axis) {  // half a turn changes nothing but signs
      Eigen::Isometry3d turned = poses[0];
      const Eigen::Vector3d about = Eigen::Vector3d::Unit(axis);
      if (rank() == last) turned.linear() = 2 * about * about.transpose() - Eigen::Matrix3d::Identity();
      CHECK(refused([&] { query(std::vector{turned}, mine); }).find(" asks about other poses than rank 0") !=
            std::string::npos);
    }
    const double side = rank() == last ? -1 : 1;
    CHECK(refused([&] {
            query(std::vector{shifted(side, 2 * side, 0)}, mine);
          }).find(" asks about other poses than rank 0") != std::string::npos);
    const std::vector<placed<point_span>> clouds(rank() == last ? 2 : 1, placed<point_span>{mine});
    CHECK(refused([&] { query(poses, clouds); }) ==
          "clearance: rank " + std::to_string(last) + " asks about 2 clouds, rank 0 about 1");
  }
  clearance::query touches(on, model, in_collision{});
  const std::vector<double> margins(rank() == last ? 2 : 1, 0.1);
  CHECK(refused([&] { touches(poses, mine, {margins}); }).find("clearance: there are 1 parts, but 2 margins") !=
        std::string::npos);
  CHECK(refused([&] { query(poses, unplugged{mine, rank() == last}); }).find("clearance: the camera is unplugged") !=
        std::string::npos);
  const point_span huge(points.data(), (std::size_t(1) << 32) / std::size_t(ranks()));  // never read
  CHECK(refused([&] { query(poses, huge); }) == "clearance: more than 2^32 - 2 points on all ranks together");
  CHECK(refused([&] { mpi::together none(MPI_COMM_NULL); }).find("no communicator") != std::string::npos);
  for (bool* const call : {&gathering_fails, &sending_fails}) {
    *call = true;
    CHECK(refused([&] {
            query(poses, mine);
          }).find(call == &sending_fails ? "clearance: MPI_Bcast: " : "clearance: MPI_Allgather: ") == 0);
    *call = false;
  }
  CHECK(same_result(query(poses, mine), expected));
}

// dies.py starts it and sees how it ends.
TEST_CASE("The last rank dies while the others ask", "[.]") {
  const auto how = std::string_view(std::getenv("CLEARANCE_TEST_DIES"));
  dice d(4);
  const auto model = clearance::make_model<clearance::sphere>(
      std::vector<std::vector<inner_sphere>>{random_primitives<inner_sphere>(d, 30, 0.3, 0.1)});
  const auto points = d.points(500, 2);
  const std::vector<Eigen::Isometry3d> poses = {shifted(0, 0, 0)};
  clearance::query query(on, model, min_distance{});
  const auto mine = piece_of(point_span(points), std::size_t(rank()), std::size_t(ranks()));
  REQUIRE(same_result(query(poses, mine), ask(host{1}, model, poses, points, min_distance{})));
  if (rank() == 0) std::printf("all live\n"), std::fflush(stdout);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == ranks() - 1) {
    if (how == "killed") std::raise(SIGKILL);
    if (how == "quits") ::_exit(0);
    if (how == "aborts") std::abort();
    gathering_kills = how == "inside";
  }
  query(poses, mine);
  std::printf("an answer\n"), std::fflush(stdout);
}

}  // namespace shard_test
