// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions about what the sensors of many machines see. Each rank of an MPI program has a piece of every cloud. Needs
// an MPI library; no other header includes this one.

#include <clearance/mpi/ranks.hpp>
#include <clearance/query/pieces.hpp>
#include <clearance/query/query.hpp>

namespace clearance::mpi {

/// The backend of a question on all ranks of `comm` at once. Each rank asks `on` (host{}, device{}, devices{...}) about
/// its own pieces of the clouds. All get the same answer about all pieces, to the bit that of one backend. Points are
/// numbered through the ranks in order; a rank may have none. All ranks must ask together, the same question about the
/// same poses, each with the robot where its `on` needs it. An exception on one rank ends the call on all.
template <class On>
struct shard {
  using several = void;

  MPI_Comm comm;
  On on = {};
};
template <class On>
shard(MPI_Comm, On) -> shard<On>;
shard(MPI_Comm) -> shard<host>;

}  // namespace clearance::mpi

namespace clearance {

/// A prepared question, with one prepared on each rank.
template <question Q, class On, class PartView>
class query<Q, mpi::shard<On>, PartView>
    : public detail::callable<query<Q, mpi::shard<On>, PartView>, mpi::shard<On>, Q> {
 public:
  template <class Robot, class... Memory>
  query(const mpi::shard<On>& on, const Robot& robot, const Q& asked, Memory... memory)
      : detail::callable<query, mpi::shard<On>, Q>(asked),
        comm_(on.comm),
        facts_(detail::facts_of(robot)),
        query_(on.on, robot, asked, memory...) {}
  template <owning_robot Robot, class... Memory>
  query(const mpi::shard<On>&, const Robot&&, const Q&,
        Memory...) = delete;  // the robot would be gone when it is asked; name it

  /// Throws std::invalid_argument if ranks do not ask the same. It also throws what this rank's own part throws; the
  /// other ranks then throw std::runtime_error with that message.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    mpi::together ranks(comm_);
    ranks.agree(facts_.size(), poses, clouds);
    typename Q::result mine{};
    ranks.attempt([&] { mine = query_(poses, clouds, q); });
    detail::joined_of<Q, PartView> joined(q, facts_);
    ranks.join(joined, mine);
    result_ = joined.result();
  }
  typename Q::result finish() { return *std::move(result_); }
  template <class... Arguments>
  void enqueue(const Arguments&...) {
    refusals::ranks_have_no_stream::explain<Q, Arguments...>();
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { query_.forget(); }

 private:
  MPI_Comm comm_;
  std::span<const part_facts> facts_;
  query<Q, On, PartView> query_;
  std::optional<typename Q::result> result_;
};

}  // namespace clearance
