// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What ranks tell one another about a question: before it, that it is the same for all; after it, their answers.

#include <clearance/frames/clouds.hpp>
#include <clearance/query/serialise.hpp>

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

/// All ranks' values, in order.
template <class T>
std::vector<T> gather(MPI_Comm comm, int ranks, const T* values, std::size_t count) {
  std::vector<T> gathered(std::size_t(ranks) * count);
  check(
      MPI_Allgather(values, int(count * sizeof(T)), MPI_BYTE, gathered.data(), int(count * sizeof(T)), MPI_BYTE, comm),
      "MPI_Allgather");
  return gathered;
}

/// One call that all ranks make together. Every rank does the same steps, whatever fails: an exception on one ends it
/// on all.
class together {
 public:
  explicit together(MPI_Comm comm) : comm_(comm) {
    int started = 0, ended = 0;
    MPI_Initialized(&started);
    MPI_Finalized(&ended);
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
      thrown_ = std::current_exception();
      sentence_ = e.what();
    } catch (...) {
      thrown_ = std::current_exception();
      sentence_ = "something that is no std::exception";
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
        sizes.push_back(cloud.size());
        mine.add(pose);
      });
      mine.clouds = sizes.size();
      mine.points = sizes.empty() ? 0 : sizes[0];
    });

    mine.thrown = thrown_ ? 1 : 0;
    const std::vector<said> said_by = gather(comm_, ranks_, &mine, 1);
    for (int r = 0; r < ranks_; ++r)
      if (said_by[std::size_t(r)].thrown != 0) end_all(r);

    for (int r = 1; r < ranks_; ++r) {
      const auto differs = [&](const char* what, std::uint64_t counted, std::uint64_t by_rank_0) {
        return "clearance: rank " + std::to_string(r) + " asks about " + std::to_string(counted) + " " + what +
               ", rank 0 about " + std::to_string(by_rank_0);
      };
      const said& rank = said_by[std::size_t(r)];
      if (rank.parts != said_by[0].parts) throw std::invalid_argument(differs("parts", rank.parts, said_by[0].parts));
      if (rank.clouds != said_by[0].clouds)
        throw std::invalid_argument(differs("clouds", rank.clouds, said_by[0].clouds));
      if (rank.poses != said_by[0].poses)
        throw std::invalid_argument("clearance: rank " + std::to_string(r) + " asks about other poses than rank 0");
    }

    std::vector<std::uint64_t> table;
    for (const said& rank : said_by) table.push_back(rank.points);
    if (sizes.size() > 1) table = gather(comm_, ranks_, sizes.data(), sizes.size());
    if (sizes.empty()) table.clear();
    sizes_ = std::move(table);

    std::uint64_t points = 0;
    for (const std::uint64_t size : sizes_) points += size;
    if (points >= ~std::uint32_t(0))
      throw std::invalid_argument("clearance: more than 2^32 - 2 points on all ranks together");
  }

  /// Joins the results of all ranks in their order: `mine` is this rank's, in the numbers of its own clouds.
  template <class Joined, class Result>
  void join(Joined& all, const Result& mine) {
    std::vector<std::byte> packed, bytes;
    attempt([&] { detail::pack(packed, mine); });
    const std::vector<std::uint64_t> sizes = all_well(packed.size());
    std::vector<std::size_t> begins{0};
    for (const std::uint64_t size : sizes) begins.push_back(begins.back() + std::size_t(size));
    attempt([&] { bytes.resize(begins.back()); });
    all_well();  // nothing throws in what follows

    for (int r = 0; r < ranks_; ++r)  // one after another, because all together may exceed what MPI's counts can say
      for (std::size_t at = begins[std::size_t(r)], end = begins[std::size_t(r) + 1]; at < end; at += most_bytes) {
        if (r == rank_)
          std::copy_n(packed.data() + (at - begins[std::size_t(r)]), std::min(end - at, most_bytes), bytes.data() + at);
        check(MPI_Bcast(bytes.data() + at, int(std::min(end - at, most_bytes)), MPI_BYTE, r, comm_), "MPI_Bcast");
      }

    attempt([&] {
      const std::size_t clouds = sizes_.size() / std::size_t(ranks_);
      std::vector<std::uint32_t> first(clouds), whole(clouds), count(clouds);
      for (std::size_t k = 0; k < sizes_.size(); ++k) whole[k % clouds] += std::uint32_t(sizes_[k]);
      for (int r = 0; r < ranks_; ++r) {
        for (std::size_t c = 0; c < clouds; ++c) count[c] = std::uint32_t(sizes_[std::size_t(r) * clouds + c]);
        Result result{};
        std::span<const std::byte> from =
            std::span(bytes).subspan(begins[std::size_t(r)], std::size_t(sizes[std::size_t(r)]));
        detail::unpack(from, result);
        all.add(std::move(result), {first, count, whole});
        for (std::size_t c = 0; c < clouds; ++c) first[c] += count[c];
      }
    });
    all_well();  // all have the answer, or none
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
  /// Each rank's `number`. Throws on all ranks if one has thrown.
  std::vector<std::uint64_t> all_well(std::uint64_t number = 0) {
    struct sent {
      std::uint64_t number, thrown;
    };
    const sent own{number, std::uint64_t(thrown_ ? 1 : 0)};
    std::vector<std::uint64_t> numbers;
    const std::vector<sent> each = gather(comm_, ranks_, &own, 1);
    for (int r = 0; r < ranks_; ++r) {
      if (each[std::size_t(r)].thrown != 0) end_all(r);
      numbers.push_back(each[std::size_t(r)].number);
    }
    return numbers;
  }
  [[noreturn]] void end_all(int by) {
    char text[512] = {};
    if (rank_ == by) std::memcpy(text, sentence_.data(), std::min(sentence_.size(), sizeof text - 1));
    check(MPI_Bcast(text, sizeof text, MPI_BYTE, by, comm_), "MPI_Bcast");
    if (thrown_) std::rethrow_exception(thrown_);
    throw std::runtime_error("clearance: rank " + std::to_string(by) + " of " + std::to_string(ranks_) + ": " + text);
  }

  static constexpr std::size_t most_bytes = std::size_t(1) << 30;  ///< The most bytes of one broadcast.

  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1;
  std::vector<std::uint64_t> sizes_;  ///< Points of all clouds, rank after rank.
  std::exception_ptr thrown_;
  std::string sentence_;
};

}  // namespace clearance::mpi
