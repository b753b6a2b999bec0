// SPDX-License-Identifier: BSD-3-Clause
// Each machine has sensors of its own before one arm: how far is it from all that they see together? mpirun -n 4
// example_ranks
#include <clearance/make_model.hpp>
#include <clearance/mpi/shard.hpp>
#include <clearance/points/sharded.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

namespace {

auto arm_of_two() {
  std::vector<clearance::inner_sphere> row;
  for (int k = 0; k < 64; ++k) row.push_back({{0.004f * float(k), 0, 0}, 0.03f});
  return clearance::make_model<clearance::sphere>(std::vector{row, row});
}
std::vector<clearance::vec3> wall() {
  std::vector<clearance::vec3> points;
  for (int k = 0; k < 300000; ++k)
    points.push_back({0.6f, 0.002f * float(k % 600) - 0.6f, 0.002f * float(k / 600) - 0.5f});
  return points;
}
std::vector<Eigen::Isometry3d> poses_at(double angle) {
  Eigen::Isometry3d shoulder = Eigen::Isometry3d::Identity(), elbow = shoulder;
  elbow.translate(Eigen::Vector3d(0.25, 0, 0)).rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  return {shoulder, elbow};
}

}  // namespace

int main(int count, char** arguments) {
  MPI_Init(&count, &arguments);
  int rank = 0, ranks = 1, wrong = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const auto arm = arm_of_two();
  const auto points = wall();  // of a real sensor a rank would have its own piece alone
  const auto mine = piece_of(clearance::point_span(points), std::size_t(rank), std::size_t(ranks));
  {
    // [ask]
    const clearance::mpi::shard all{MPI_COMM_WORLD, clearance::host{1}};  // or device{}, devices{0, 1}
    clearance::query ask(all, arm, clearance::min_distance{});
    for (const double angle : {1.5, 1.0, 0.5, 0.0}) {
      const clearance::min_distance_result r = ask(poses_at(angle), mine);  // on every rank; all get the same answer
      // [ask]
      if (rank == 0)
        std::printf("%.1f rad: %.3f m, certainly more than %.3f m, to point %u of %llu on %d ranks\n", angle,
                    double(r.distance), double(r.lower), r.point, static_cast<unsigned long long>(r.seen), ranks);
      const auto same = clearance::ask(clearance::host{1}, arm, poses_at(angle), points, clearance::min_distance{});
      wrong += r.distance != same.distance || r.lower != same.lower || r.point != same.point ||
               r.primitive != same.primitive || r.valid != same.valid;
    }
  }
  MPI_Finalize();
  return wrong;
}
