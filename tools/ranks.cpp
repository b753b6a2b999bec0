// SPDX-License-Identifier: BSD-3-Clause
#include "ranks.hpp"

#include <clearance/mpi/ranks.hpp>
#include <clearance/points/sharded.hpp>

#include <cstdlib>

using namespace clearance;

namespace {

class mpi_ranks final : public all_ranks {
 public:
  mpi_ranks() {
    int given = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given);  // other threads only search
    std::atexit([] {                                                 // after everything is printed
      MPI_Barrier(MPI_COMM_WORLD);  // mpirun ends all ranks at the first exit code that is not 0
      MPI_Finalize();
    });
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
  }

  bool speaks() const override { return rank_ == 0; }

  std::vector<seen_points> share(std::vector<seen_points> clouds) const override {
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      if (auto* points = std::get_if<point_span>(&clouds[i].points))
        *points = piece_of(*points, std::size_t(rank_), std::size_t(ranks_));
      else if (i % std::size_t(ranks_) != std::size_t(rank_))
        std::get<depth_image<std::uint16_t>>(clouds[i].points).height = 0;
    }
    return clouds;
  }

  reply together(const std::function<reply()>& ask, poses_of poses, const std::vector<seen_points>& share,
                 bool solid) override {
    std::vector<std::variant<placed<point_span>, placed<depth_image<std::uint16_t>>>> mine;
    for (const seen_points& cloud : share)
      std::visit([&](const auto& source) { mine.push_back(placed{source, cloud.pose}); }, cloud.points);
    meet({});
    mpi::question all(MPI_COMM_WORLD);
    all.agree(poses.size(), poses, mine);
    reply out;
    all.attempt([&] { out = ask(); });
    out.result = all.answer(out.result, out.parts, solid);
    return out;
  }

  /// Waits until all are here. Throws an error of this rank or of another.
  void meet(std::exception_ptr failure) {
    met_ = true;
    mpi::question here(MPI_COMM_WORLD);
    here.attempt([&] {
      if (failure) std::rethrow_exception(failure);
    });
    here.agree(0, {}, std::vector<point_span>{});
    here.answer({}, {}, false);
  }
  bool met() const { return met_; }

 private:
  int rank_ = 0, ranks_ = 1;
  bool met_ = false;
};

}  // namespace

int on_all_ranks(const std::function<int(all_ranks&)>& work) {
  mpi_ranks all;
  try {
    return work(all);
  } catch (...) {
    if (!all.met()) all.meet(std::current_exception());  // the others wait for it
    throw;
  }
}
