// SPDX-License-Identifier: BSD-3-Clause
// mpirun -n 3 example_own_question_ranks
#include "own_question.hpp"

#include <clearance/mpi/shard.hpp>

int main(int count, char** arguments) {
  using namespace own_question;
  MPI_Init(&count, &arguments);
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const auto robot = clearance::make_model<clearance::sphere>(links());
  const std::vector<clearance::vec3> points = cloud();
  // [ranks]
  const auto mine = clearance::piece_of(clearance::point_span(points), std::size_t(rank), std::size_t(ranks));
  const clearance::mpi::shard all{MPI_COMM_WORLD, clearance::host{1}};
  const int failures = wrong("ranks", clearance::ask(all, robot, poses(), mine, nearness{}));
  // [ranks]
  MPI_Finalize();
  return failures;
}
