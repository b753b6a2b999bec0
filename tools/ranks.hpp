// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// `--shard`: the processes started by mpirun answer together.

#include "backends.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

using named_values = std::vector<std::pair<std::string, std::string>>;

/// All ranks, as this one sees them.
class all_ranks {
 public:
  virtual ~all_ranks() = default;

  /// Does this rank print the answer?
  virtual bool speaks() const = 0;

  /// The robot of all ranks. All show it the same clouds, and ask it the same in the same order; each has its own
  /// robot, `mine`, asked about its share of each cloud's points: a contiguous piece, but a whole image goes to one
  /// rank. All get the answer about all points. It throws on all ranks if they differ in robot, clouds, poses or
  /// `options`, which have names and values.
  virtual std::unique_ptr<backend_robot> together(std::unique_ptr<backend_robot> mine, const asked_model& asked,
                                                  const named_values& options) = 0;

  /// Each rank calls this after its last question. It waits until all have their answers.
  virtual void part() = 0;
};

/// Returns what `work` returns on this rank. If it throws on one rank before `part`, it ends on all: that one throws
/// its error, the others its sentence. Throws usage_error if built without MPI.
int on_all_ranks(const std::function<int(all_ranks&)>& work);
