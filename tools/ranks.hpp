// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// `--shard`: the processes started by mpirun answer together.

#include "questions/asked.hpp"

#include <functional>

/// All ranks, as this one sees them. All are shown the same clouds, and asked the same in the same order; each asks
/// about its share of each cloud's points: a contiguous piece, but a whole image goes to one rank. All get the answer
/// about all points. It throws on all ranks if they differ in robot, clouds, poses or options.
class all_ranks {
 public:
  virtual ~all_ranks() = default;

  /// Does this rank print the answer?
  virtual bool speaks() const = 0;

  /// What all ranks must have alike from now on: the robot, and options by name and value.
  virtual void agree_on(const asked_model& asked, const named_values& options) = 0;
  /// This rank's share of the clouds.
  virtual std::vector<whole_cloud> share(const std::vector<whole_cloud>& clouds) = 0;

  /// Each rank calls this after its last question. It waits until all have their answers.
  virtual void part() = 0;
};

/// Asks a question of this rank's share and joins all ranks' answers; null: ranks are not asked this. `ask` is given
/// the question about the share.
template <class Q>
struct joined_on_ranks {
  using result = typename Q::result;
  static inline result (*ask)(all_ranks& all, poses_of poses, const Q& q,
                              const std::function<result(const Q&)>& ask) = nullptr;
};

/// Returns what `work` returns on this rank. If it throws on one rank before `part`, it ends on all: that one throws
/// its error, the others its sentence. Throws usage_error if built without MPI.
int on_all_ranks(const std::function<int(all_ranks&)>& work);
