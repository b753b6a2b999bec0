// SPDX-License-Identifier: BSD-3-Clause
// What ranks add to the slowest of them: mpirun -n N bench_mpi_shard. Each rank has a frame of 300k points. Medians of
// the time from a barrier to the answer, on all ranks together and on the slowest alone, and of one 8-byte reduction.
#include <clearance/make_model.hpp>
#include <clearance/mpi/shard.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <chrono>
#include <cstdio>
#include <random>

namespace {

/// The slowest rank's microseconds, median of `calls`.
template <class F>
double median(int calls, F call) {
  std::vector<double> us;
  const int others = calls / 10;
  for (int k = 0; k < others + calls; ++k) {
    MPI_Barrier(MPI_COMM_WORLD);
    const auto start = std::chrono::steady_clock::now();
    call();
    double its = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    MPI_Allreduce(MPI_IN_PLACE, &its, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (k >= others) us.push_back(its);
  }
  std::sort(us.begin(), us.end());
  return us[us.size() / 2];
}

}  // namespace

int main(int count, char** arguments) {
  MPI_Init(&count, &arguments);
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  std::mt19937 bits{unsigned(rank)};
  std::uniform_real_distribution<float> across(-1, 1);
  std::vector<std::vector<clearance::inner_sphere>> links(7);
  for (auto& link : links)
    for (int k = 0; k < 500; ++k)
      link.push_back({{0.1f * across(bits), 0.1f * across(bits), 0.1f * across(bits)}, 0.02f});
  const auto arm = clearance::make_model<clearance::sphere>(links);
  std::vector<Eigen::Isometry3d> poses(7, Eigen::Isometry3d::Identity());
  for (std::size_t k = 0; k < 7; ++k) poses[k].translation().x() = 0.15 * double(k);
  for (const std::size_t points : {std::size_t(1000), std::size_t(307200)}) {
    std::vector<clearance::vec3> cloud;
    for (std::size_t i = 0; i < points; ++i)
      cloud.push_back({3 * across(bits), 3 * across(bits), 0.5f + across(bits) * 0.05f});
    clearance::query alone(clearance::host{1}, arm, clearance::min_distance{});
    clearance::query together(clearance::mpi::shard{MPI_COMM_WORLD, clearance::host{1}}, arm,
                              clearance::min_distance{});
    const int calls = points > 100000 ? 200 : 2000;
    const double slowest = median(calls, [&] { alone(poses, cloud); }),
                 all = median(calls, [&] { together(poses, cloud); });
    double one = 0;
    const double reduction =
        median(calls, [&] { MPI_Allreduce(MPI_IN_PLACE, &one, 1, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD); });
    if (rank == 0)
      std::printf(
          "%d ranks, %zu points each: slowest rank %.1f us, all together %.1f us, added %.1f us; one reduction of 8 "
          "bytes %.1f us\n",
          ranks, points, slowest, all, all - slowest, reduction);
  }
  MPI_Finalize();
}
