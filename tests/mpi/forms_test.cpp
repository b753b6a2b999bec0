// SPDX-License-Identifier: BSD-3-Clause
// With any number of ranks, every question that can be merged gives each rank the bits of one process.
#include "forms/forms.hpp"
#include "support/catch.hpp"

#include <clearance/mpi/shard.hpp>

namespace forms_mpi_test {

using namespace testing;
using clearance::host;

TEST_CASE("All ranks get the answer of one process to every question that can be merged") {
  verdict v;
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const clearance::mpi::shard all{MPI_COMM_WORLD, host{1}};
  ask_everything([&]<class Q>(const char* name, const Q& q, const auto& model, const moving_frames& f) {
    if constexpr (forms_of<Q>::in_pieces) {
      const auto mine =
          clearance::mapped_clouds(f.here(), clearance::detail::one_piece{std::size_t(rank), std::size_t(ranks)});
      v.require(same_answer(ask(host{1}, model, f.s.poses, f.here(), q), ask(all, model, f.s.poses, mine, q)), name,
                ", frame ", f.number, " on rank ", rank);
    }
  });
}

TEST_CASE("Ranks that walk by a traversal of the caller's get the answer of one process") {
  verdict v;
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const clearance::mpi::shard all{MPI_COMM_WORLD, clearance::plain{host{1}, clearance::stack{}}};
  const moving_frames f(4, 83);
  const auto model = f.model();
  const auto mine =
      clearance::mapped_clouds(f.here(), clearance::detail::one_piece{std::size_t(rank), std::size_t(ranks)});
  const auto same = [&](const auto& q) {
    return same_answer(ask(host{1}, model, f.s.poses, f.here(), q), ask(all, model, f.s.poses, mine, q));
  };
  v.require(same(clearance::min_distance{}), "min_distance on rank ", rank);
  v.require(same(clearance::zones{.thresholds = {0.1, 0.4}}), "zones on rank ", rank);
  v.require(same(clearance::distances{.d_max = 0.6, .which = true}), "distances on rank ", rank);
}

}  // namespace forms_mpi_test
