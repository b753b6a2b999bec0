// SPDX-License-Identifier: BSD-3-Clause
#include "ranks.hpp"

#include <clearance/io/bytes.hpp>
#include <clearance/io/digest.hpp>
#include <clearance/io/robot_bodies.hpp>
#include <clearance/mpi/ranks.hpp>
#include <clearance/points/sharded.hpp>
#include <clearance/query/pieces.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/questions/zones.hpp>

#include <cstdlib>

using namespace clearance;

namespace {

/// Parts, as far as joining answers depends on them: spheres, and triangles with a solid.
struct parts_of_spheres {
  using interior_type = no_interior;
};
struct parts_of_triangles {
  struct interior_type {};
};

/// Joins the witnesses of each rank's own minima.
struct joined_witnesses {
  std::vector<part_witness> joined;

  void add(const std::vector<part_witness>& of_rank, const piece_place& place) {
    joined.resize(of_rank.size());
    for (std::size_t k = 0; k < of_rank.size(); ++k) {
      if (of_rank[k].part == none) continue;
      joined[k] = of_rank[k];
      joined[k].point += place.first[joined[k].cloud];
    }
  }
  std::vector<part_witness> result() { return std::move(joined); }
};

/// The digest of what decides every distance to the robot, but for its poses.
io::digest digest_of(const std::vector<body>& bodies) {
  io::byte_writer out;
  for (const body& one : bodies) {
    out.put(one.name);
    out.put(one.tolerance);
    out.put(one.packed.gap);
    out.put(one.packed.tolerance);
    for (const std::uint8_t b : io::digest_of(one.closed).bytes) out.put(b);
    for (const inner_sphere& s : one.packed.spheres) {
      for (const real x : {s.center.x, s.center.y, s.center.z, s.radius}) out.put(x);
    }
  }
  return io::digest_of(out.bytes());
}

/// The digest of a cloud's records, of which of them count, and of its pose.
template <class S>
io::digest digest_of(const S& cloud, const Eigen::Isometry3d& pose) {
  io::byte_writer out;
  const auto records = cloud.bytes();
  for (const std::uint8_t b :
       io::digest_of(std::string_view(reinterpret_cast<const char*>(records.data()), records.size())).bytes)
    out.put(b);
  for (const double x : pose.matrix().reshaped()) out.put(x);
  if constexpr (requires { cloud.filter; }) {
    out.put(double(cloud.filter.nearest));
    out.put(double(cloud.filter.farthest));
  } else {
    for (const real x :
         {cloud.inverse_fx, cloud.inverse_fy, cloud.cx, cloud.cy, cloud.scale, cloud.nearest, cloud.farthest})
      out.put(double(x));
    out.put(std::uint64_t(cloud.width));
    out.put(std::uint64_t(cloud.height));
  }
  return io::digest_of(out.bytes());
}

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

  void agree_on(const asked_model& asked, const named_values& options) override {
    parts_ = asked.bodies->size();
    of_spheres_ = asked.model == model_kind::spheres;
    alike_.clear();
    for (const auto& [name, value] : options) alike_.push_back({name, io::digest_of(value)});
    alike_.push_back({"robot", digest_of(*asked.bodies)});
  }
  std::vector<whole_cloud> share(const std::vector<whole_cloud>& clouds) override {
    share_.clear();
    first_.clear();
    std::vector<std::pair<std::string, io::digest>> seen;
    for (const whole_cloud& one : clouds)
      std::visit(
          [&](const auto& placed_cloud) {
            seen.push_back(
                {"cloud " + std::to_string(share_.size()), digest_of(placed_cloud.source, placed_cloud.pose)});
            take_share(placed_cloud.source, placed_cloud.pose);
          },
          one);
    at_once([&](mpi::together& ranks_together) {
      auto anywhere = share_;  // poses are compared below, where an option's name is said
      for (auto& one : anywhere) std::visit([](auto& mine) { mine.pose = Eigen::Isometry3d::Identity(); }, one);
      ranks_together.agree(parts_, {}, anywhere);  // the first step of all, also of one that has failed
      compare(alike_);
      compare(seen);
    });
    return share_;
  }

  /// This rank's answer about its share, joined with those of all others.
  template <class Joined, class Ask>
  auto joined(Joined answer, poses_of poses, const Ask& ask) -> decltype(answer.result()) {
    return at_once([&](mpi::together& ranks_together) {
      ranks_together.agree(parts_, poses, share_);
      decltype(ask()) mine{};
      ranks_together.attempt([&] { mine = ask(); });
      ranks_together.join(answer, mine);
      return answer.result();
    });
  }
  bool of_spheres() const { return of_spheres_; }
  /// The minima whose points are in this rank's share.
  std::vector<part_minimum> own(std::span<const part_minimum> minima) const {
    std::vector<part_minimum> of_this_rank(minima.begin(), minima.end());
    for (part_minimum& minimum : of_this_rank) {
      if (minimum.cloud == none) continue;
      const std::size_t count = std::visit([](const auto& mine) { return mine.source.size(); }, share_[minimum.cloud]);
      minimum.point -= std::uint32_t(first_[minimum.cloud]);
      if (minimum.point >= count) minimum = {};  // it is another rank's
    }
    return of_this_rank;
  }

  void part() override {
    meet({});
    parted_ = true;
  }
  /// Waits for all others, wherever they meet next. Throws an error of this rank or of another.
  void meet(std::exception_ptr failure) {
    at_once([&](mpi::together& ranks_together) {
      ranks_together.attempt([&] {
        if (failure) std::rethrow_exception(failure);
      });
      ranks_together.agree(0, {}, std::vector<point_span>{});
    });
  }
  /// What all do together. If it throws, all ranks know.
  template <class Work>
  std::invoke_result_t<Work, mpi::together&> at_once(const Work& work) {
    try {
      mpi::together ranks_together(MPI_COMM_WORLD);
      return work(ranks_together);
    } catch (...) {
      parted_ = true;
      throw;
    }
  }
  bool parted() const { return parted_; }

 private:
  std::size_t rank() const { return std::size_t(rank_); }
  std::size_t ranks() const { return std::size_t(ranks_); }

  /// Throws on every rank if one has something else than rank 0. All have as many.
  void compare(const std::vector<std::pair<std::string, io::digest>>& alike) const {
    std::vector<io::digest> mine;
    for (const auto& value : alike) mine.push_back(value.second);
    const std::vector<io::digest> each = mpi::gather(MPI_COMM_WORLD, ranks_, mine.data(), mine.size());
    for (std::size_t i = 0; i < each.size(); ++i)
      if (const std::size_t k = i % mine.size(); each[i] != each[k])
        throw std::invalid_argument("rank " + std::to_string(i / mine.size()) + " has another " + alike[k].first +
                                    " than rank 0");
  }
  void take_share(const point_span& whole, const Eigen::Isometry3d& pose) {
    first_.push_back(first_of_piece(whole, rank(), ranks()));
    share_.push_back(placed{piece_of(whole, rank(), ranks()), pose});
  }
  /// One rank has the whole image; the others have no point of it, but its error, as brackets are about all clouds.
  void take_share(const depth_image<std::uint16_t>& image, const Eigen::Isometry3d& pose) {
    const bool mine = share_.size() % ranks() == rank();
    first_.push_back(0);
    if (mine) return share_.push_back(placed{image, pose});
    point_span none_of_it;
    none_of_it.off = image.rounding();
    share_.push_back(placed{none_of_it, pose});
  }

  int rank_ = 0, ranks_ = 1;
  bool parted_ = false, of_spheres_ = true;
  std::size_t parts_ = 0;
  std::vector<std::pair<std::string, io::digest>> alike_;  // what all ranks must have: its name, and its value
  std::vector<whole_cloud> share_;                         // of each cloud,
  std::vector<std::size_t> first_;                         // and the number of its first point
};

/// Lets all ranks join answers to Q, as those to `As` are joined.
template <class Q, class As = Q>
struct joinable {
  joinable() {
    joined_on_ranks<Q>::ask = [](all_ranks& all, poses_of poses, const Q& q,
                                 const std::function<typename Q::result(const Q&)>& ask) {
      auto& ranks = static_cast<mpi_ranks&>(all);
      const std::span<const part_facts> facts;  // none of these answers needs them to be joined
      const auto mine = [&] { return ask(q); };
      if (ranks.of_spheres())
        return ranks.joined(clearance::detail::joined_of<As, parts_of_spheres>(As{}, facts), poses, mine);
      return ranks.joined(clearance::detail::joined_of<As, parts_of_triangles>(As{}, facts), poses, mine);
    };
  }
};
const joinable<min_distance_per_part> joins_least;
const joinable<zones> joins_zones;
const joinable<distances> joins_distances;
const joinable<signed_distances, distances> joins_signed_distances;
const joinable<nearest_k> joins_nearest;
const joinable<self_filter> joins_labels;
const joinable<min_distances> joins_plans;
const bool joins_witnesses = [] {
  joined_on_ranks<part_witnesses>::ask =
      [](all_ranks& all, poses_of poses, const part_witnesses& q,
         const std::function<std::vector<part_witness>(const part_witnesses&)>& ask) {
        auto& ranks = static_cast<mpi_ranks&>(all);
        const std::vector<part_minimum> own = ranks.own(q.minima);
        return ranks.joined(joined_witnesses{}, poses, [&] { return ask(part_witnesses{own}); });
      };
  return true;
}();

}  // namespace

int on_all_ranks(const std::function<int(all_ranks&)>& work) {
  mpi_ranks all;
  try {
    return work(all);
  } catch (...) {
    if (!all.parted()) all.meet(std::current_exception());  // the others wait for it
    throw;
  }
}
