// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// `clearance query --shard`: the processes that mpirun started ask together.

#include "backends.hpp"

#include <functional>

/// All of them, seen from this one.
class all_ranks {
 public:
  virtual ~all_ranks() = default;

  /// Is this the one that answers?
  virtual bool speaks() const = 0;

  /// Of each cloud the points that this rank asks about: a contiguous share, but an image is one rank's as a whole.
  virtual std::vector<seen_points> share(std::vector<seen_points> clouds) const = 0;

  /// To be called once by each: what each rank's `ask` says of its share becomes the answer about all. `solid`: points
  /// may be inside.
  virtual reply together(const std::function<reply()>& ask, poses_of poses, const std::vector<seen_points>& share,
                         bool solid) = 0;
};

/// What `work` returns on this rank. If it throws on one before all are together, or while they ask, it ends on all:
/// that one throws what it threw, the others its sentence. Throws usage_error if this is built without MPI.
int on_all_ranks(const std::function<int(all_ranks&)>& work);
