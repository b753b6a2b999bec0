// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// `clearance query --shard`: the processes started by mpirun answer together.

#include "backends.hpp"

#include <functional>

/// All ranks, as this one sees them.
class all_ranks {
 public:
  virtual ~all_ranks() = default;

  /// Does this rank print the answer?
  virtual bool speaks() const = 0;

  /// This rank's share of each cloud's points: a contiguous piece, but a whole image goes to one rank.
  virtual std::vector<seen_points> share(std::vector<seen_points> clouds) const = 0;

  /// Each rank calls this once. It joins the results of every rank's `ask` about its share into one answer about all
  /// points. `solid`: points may be inside.
  virtual reply together(const std::function<reply()>& ask, poses_of poses, const std::vector<seen_points>& share,
                         bool solid) = 0;
};

/// Returns what `work` returns on this rank. If it throws on one rank before or while all ask together, it ends on all:
/// that one throws its error, the others its sentence. Throws usage_error if built without MPI.
int on_all_ranks(const std::function<int(all_ranks&)>& work);
