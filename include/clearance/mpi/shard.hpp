// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from what the sensors of many machines see? Each rank of an MPI program has a piece of every
// cloud. Needs an MPI library; no other header includes this one.

#include <clearance/min_distance_query.hpp>
#include <clearance/mpi/ranks.hpp>
#include <clearance/scan/interior.hpp>

namespace clearance::mpi {

/// The backend of min_distance, min_distance_per_part and min_distance_query on all ranks of `comm` at once. Each rank
/// asks `on` (host{}, device{}, devices{...}) about its own pieces of the clouds. All get the same answer about all
/// pieces, to the bit that of one backend. Points are numbered through the ranks in order; a rank may have none. All
/// ranks must ask together, about the same poses, each with the robot where its `on` needs it. An exception on one rank
/// ends the call on all.
template <class On>
struct shard {
  MPI_Comm comm;
  On on = {};
};
template <class On>
shard(MPI_Comm, On) -> shard<On>;
shard(MPI_Comm) -> shard<host>;

}  // namespace clearance::mpi

namespace clearance {

/// The prepared question, with one prepared on each rank.
template <class On, class PartView>
class min_distance_query<mpi::shard<On>, PartView> {
 public:
  template <robot Robot>
  min_distance_query(const mpi::shard<On>& on, const Robot& robot)
      : comm_(on.comm), parts_(view_of(robot).facts.size()), query_(on.on, robot) {}

  /// As min_distance. Throws std::invalid_argument if ranks do not ask the same. It also throws what this rank's own
  /// part throws; the other ranks then throw std::runtime_error with that message.
  template <class... Clouds>
  min_distance_result operator()(std::span<const Eigen::Isometry3d> poses, const Clouds&... clouds) {
    return ask(poses, as_clouds(clouds...), {}, [&](const auto& mine) { return query_(poses, mine); });
  }
  template <class Clouds>
  min_distance_result per_part(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                               std::span<part_minimum> minima) {
    // `query_` refuses a wrong number of minima within `attempt`: throwing here would leave the others waiting.
    return ask(poses, clouds, minima, [&](const auto& mine) { return query_.per_part(poses, mine, minima); });
  }

  void forget() { query_.forget(); }

 private:
  template <class Clouds, class Local>
  min_distance_result ask(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds,
                          std::span<part_minimum> minima, const Local& local) {
    static_assert(explain_clouds<Clouds>());
    mpi::question all(comm_);
    all.agree(parts_, poses, clouds);
    min_distance_result mine;
    all.attempt([&] { mine = local(clouds); });
    return all.answer(mine, minima, scan::has_interior<PartView>);
  }

  MPI_Comm comm_;
  std::size_t parts_;
  min_distance_query<On, PartView> query_;
};

namespace minimum {

/// One call on each rank. Its answer is in host memory.
template <class On>
struct search_on<mpi::shard<On>> {
  static host backend_of(const mpi::shard<On>&) { return {}; }

  template <bool PerPart, class View, class Clouds, class Here>
  static void once(const mpi::shard<On>& on, const View& robot, std::span<const Eigen::Isometry3d> poses,
                   const Clouds& clouds, min_distance_result* result, part_minimum* minima, const Here&) {
    static_assert(!std::is_same_v<Here, as_it_is>,
                  "ranks have no one stream to enqueue in: their answer is waited for");
    mpi::question all(on.comm);
    all.agree(robot.size(), poses, clouds);
    min_distance_result mine;
    std::vector<part_minimum> each(PerPart ? robot.size() : 0);
    all.attempt(
        [&] { mine = detail::least_distance<PerPart>(on.on, robot, poses, clouds, PerPart ? &each : nullptr); });
    *result = all.answer(mine, each, scan::has_interior<typename View::part_type>);
    if constexpr (PerPart) std::ranges::copy(each, minima);
  }
};

}  // namespace minimum

}  // namespace clearance
