// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What ranks tell one another about a question: before it, that it is the same for all; after it, their answers.

#include <clearance/answer/of_pieces.hpp>
#include <clearance/frame/clouds.hpp>

#include <mpi.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <exception>
#include <string>
#include <type_traits>
#include <vector>

namespace clearance::mpi {

/// Throws std::runtime_error if the communicator returns errors (MPI_ERRORS_RETURN). By default errors end the program.
inline void check(int error, const char* call) {
  if (error == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING] = {};
  int length = 0;
  MPI_Error_string(error, text, &length);
  throw std::runtime_error(std::string("clearance: ") + call + ": " + text);
}

/// Reduces plain values over all ranks with their own `add`, which is associative and commutative.
template <class T>
void reduce(MPI_Comm comm, T* values, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  // Made once and kept as long as the process, because they must not be freed after MPI_Finalize.
  static const MPI_Datatype type = [] {
    MPI_Datatype made;
    check(MPI_Type_contiguous(int(sizeof(T)), MPI_BYTE, &made), "MPI_Type_contiguous");
    check(MPI_Type_commit(&made), "MPI_Type_commit");
    return made;
  }();
  static const MPI_Op operation = [] {
    MPI_Op made;
    MPI_User_function* const add = [](void* from, void* to, int* n, MPI_Datatype*) {
      for (int k = 0; k < *n; ++k) {
        T a, b;
        std::memcpy(&a, static_cast<char*>(from) + std::size_t(k) * sizeof(T), sizeof(T));
        std::memcpy(&b, static_cast<char*>(to) + std::size_t(k) * sizeof(T), sizeof(T));
        b.add(a);
        std::memcpy(static_cast<char*>(to) + std::size_t(k) * sizeof(T), &b, sizeof(T));
      }
    };
    check(MPI_Op_create(add, 1, &made), "MPI_Op_create");
    return made;
  }();
  check(MPI_Allreduce(MPI_IN_PLACE, values, int(count), type, operation, comm), "MPI_Allreduce");
}

/// All ranks' values, in order.
template <class T>
std::vector<T> gather(MPI_Comm comm, int ranks, const T* values, std::size_t count) {
  std::vector<T> all(std::size_t(ranks) * count);
  check(MPI_Allgather(values, int(count * sizeof(T)), MPI_BYTE, all.data(), int(count * sizeof(T)), MPI_BYTE, comm),
        "MPI_Allgather");
  return all;
}

/// One question that all ranks ask. Every rank makes the same calls, whatever fails: an exception on one ends it on
/// all.
class question {
 public:
  explicit question(MPI_Comm comm) : comm_(comm) {
    int started = 0, ended = 0;
    MPI_Initialized(&started), MPI_Finalized(&ended);
    if (started == 0 || ended != 0 || comm == MPI_COMM_NULL)
      throw std::invalid_argument(
          "clearance: ranks, but MPI_Init was not called, or MPI_Finalize was, or there is no communicator");
    check(MPI_Comm_rank(comm, &rank_), "MPI_Comm_rank");
    check(MPI_Comm_size(comm, &ranks_), "MPI_Comm_size");
  }

  /// Does `work()` on this rank. Keeps its exception, which `agree` or `answer` reports.
  template <class Work>
  void attempt(const Work& work) {
    try {
      if (!thrown_) work();
    } catch (const std::exception& e) {
      thrown_ = std::current_exception(), sentence_ = e.what();
    } catch (...) {
      thrown_ = std::current_exception(), sentence_ = "something that is no std::exception";
    }
  }

  /// Throws on all ranks if one has thrown, or asks about another number of parts or clouds or about other poses, or if
  /// there are too many points. Afterwards it is known where this rank's points begin.
  template <class Clouds>
  void agree(std::size_t parts, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds) {
    said mine{parts, 0, 0, 0, 0};
    std::vector<std::uint64_t> sizes;
    attempt([&] {
      for (const Eigen::Isometry3d& pose : poses) mine.add(pose);
      for_each_cloud(clouds, [&](const auto& cloud, const Eigen::Isometry3d& pose) {
        sizes.push_back(cloud.size()), mine.add(pose);
      });
      mine.clouds = sizes.size(), mine.points = sizes.empty() ? 0 : sizes[0];
    });
    mine.thrown = thrown_ ? 1 : 0;
    const std::vector<said> all = gather(comm_, ranks_, &mine, 1);
    for (int r = 0; r < ranks_; ++r)
      if (all[std::size_t(r)].thrown != 0) end_all(r);
    for (int r = 1; r < ranks_; ++r) {
      const auto differs = [&](const char* what, std::uint64_t its, std::uint64_t others) {
        return "clearance: rank " + std::to_string(r) + " asks about " + std::to_string(its) + " " + what +
               ", rank 0 about " + std::to_string(others);
      };
      const said& its = all[std::size_t(r)];
      if (its.parts != all[0].parts) throw std::invalid_argument(differs("parts", its.parts, all[0].parts));
      if (its.clouds != all[0].clouds) throw std::invalid_argument(differs("clouds", its.clouds, all[0].clouds));
      if (its.poses != all[0].poses)
        throw std::invalid_argument("clearance: rank " + std::to_string(r) + " asks about other poses than rank 0");
    }
    std::vector<std::uint64_t> table;
    for (const said& its : all) table.push_back(its.points);
    if (sizes.size() > 1) table = gather(comm_, ranks_, sizes.data(), sizes.size());
    first_.assign(sizes.size(), 0);
    std::uint64_t points = 0;
    for (std::size_t k = 0; k < table.size() && !sizes.empty(); ++k) {
      if (k < std::size_t(rank_) * sizes.size()) first_[k % sizes.size()] += table[k];
      points += table[k];
    }
    if (points >= none) throw std::invalid_argument("clearance: more than 2^32 - 2 points on all ranks together");
  }

  /// From this rank's answers, in the numbers of its own clouds, to those of all ranks. `minima`: one per part, or
  /// empty.
  min_distance_result answer(const min_distance_result& mine, std::span<part_minimum> minima, bool has_interior) {
    sum all{minimum::of_pieces(in_whole(mine)), thrown_ ? std::uint32_t(rank_) : none};
    reduce(comm_, &all, 1);
    if (all.thrown != none) end_all(int(all.thrown));
    if (!minima.empty()) {
      std::vector<part> parts;
      for (const part_minimum& m : minima) parts.push_back({in_whole(m)});
      reduce(comm_, parts.data(), parts.size());
      std::ranges::transform(parts, minima.begin(), [](const part& p) { return p.least; });
    }
    return all.pieces.answer(has_interior);
  }

 private:
  struct said {
    std::uint64_t parts, clouds, poses, points, thrown;

    /// Each step is one to one and spreads every bit, so that half a turn, which flips some signs, shows.
    void add(const Eigen::Isometry3d& pose) {
      for (int k = 0; k < 16; ++k) {
        poses = (poses ^ std::bit_cast<std::uint64_t>(pose.matrix().data()[k] + 0.0)) *
                0xbf58476d1ce4e5b9;  // -0 is 0; as splitmix64
        poses = (poses ^ poses >> 30) * 0x94d049bb133111eb;
        poses ^= poses >> 31;
      }
    }
  };
  struct sum {
    minimum::of_pieces pieces;
    std::uint32_t thrown;  ///< The lowest rank that threw.

    void add(const sum& other) { pieces.add(other.pieces), thrown = std::min(thrown, other.thrown); }
  };
  struct part {
    part_minimum least;

    void add(const part& other) { least = merge(least, other.least); }
  };

  template <class Answer>
  Answer in_whole(const Answer& r) const {
    return r.cloud == none ? r : renumbered(r, 0, std::uint32_t(first_[r.cloud]));
  }
  [[noreturn]] void end_all(int by) {
    char text[512] = {};
    if (rank_ == by) std::memcpy(text, sentence_.data(), std::min(sentence_.size(), sizeof text - 1));
    check(MPI_Bcast(text, sizeof text, MPI_BYTE, by, comm_), "MPI_Bcast");
    if (thrown_) std::rethrow_exception(thrown_);
    throw std::runtime_error("clearance: rank " + std::to_string(by) + " of " + std::to_string(ranks_) + ": " + text);
  }

  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1;
  std::vector<std::uint64_t> first_;
  std::exception_ptr thrown_;
  std::string sentence_;
};

}  // namespace clearance::mpi
