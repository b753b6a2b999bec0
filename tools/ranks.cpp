// SPDX-License-Identifier: BSD-3-Clause
#include "ranks.hpp"

#include "robot_bodies.hpp"
#include "stopwatch.hpp"

#include <clearance/io/bytes.hpp>
#include <clearance/io/digest.hpp>
#include <clearance/io/joint_motion.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/mpi/ranks.hpp>
#include <clearance/points/sharded.hpp>
#include <clearance/query/pieces.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/unseen.hpp>
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
  std::vector<part_witness> all;

  void add(const std::vector<part_witness>& its, const piece_place& place) {
    all.resize(its.size());
    for (std::size_t k = 0; k < its.size(); ++k) {
      if (its[k].part == none) continue;
      all[k] = its[k];
      all[k].point += place.first[all[k].cloud];
    }
  }
  std::vector<part_witness> result() { return std::move(all); }
};

/// Of what decides every distance to the robot, but for its poses.
io::digest digest_of(const std::vector<body>& bodies) {
  io::byte_writer all;
  for (const body& its : bodies) {
    all.put(its.name), all.put(its.tolerance), all.put(its.packed.gap), all.put(its.packed.tolerance);
    for (const std::uint8_t b : io::digest_of(its.closed).bytes) all.put(b);
    for (const inner_sphere& s : its.packed.spheres) {
      for (const real x : {s.center.x, s.center.y, s.center.z, s.radius}) all.put(x);
    }
  }
  return io::digest_of(all.bytes());
}

/// Of a cloud's records, of which of them count, and of its pose.
template <class S>
io::digest digest_of(const S& cloud, const Eigen::Isometry3d& pose) {
  io::byte_writer all;
  const auto records = cloud.bytes();
  for (const std::uint8_t b :
       io::digest_of(std::string_view(reinterpret_cast<const char*>(records.data()), records.size())).bytes)
    all.put(b);
  for (const double x : pose.matrix().reshaped()) all.put(x);
  if constexpr (requires { cloud.filter; }) {
    all.put(double(cloud.filter.nearest)), all.put(double(cloud.filter.farthest));
  } else {
    for (const real x :
         {cloud.inverse_fx, cloud.inverse_fy, cloud.cx, cloud.cy, cloud.scale, cloud.nearest, cloud.farthest})
      all.put(double(x));
    all.put(std::uint64_t(cloud.width)), all.put(std::uint64_t(cloud.height));
  }
  return io::digest_of(all.bytes());
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

  std::unique_ptr<backend_robot> together(std::unique_ptr<backend_robot> mine, const asked_model& asked,
                                          const named_values& options) override;

  void part() override {
    meet({});
    parted_ = true;
  }
  /// Waits for all others, wherever they meet next. Throws an error of this rank or of another.
  void meet(std::exception_ptr failure) {
    at_once([&](mpi::together& here) {
      here.attempt([&] {
        if (failure) std::rethrow_exception(failure);
      });
      here.agree(0, {}, std::vector<point_span>{});
    });
  }
  /// What all do together. If it throws, all ranks know.
  template <class Work>
  std::invoke_result_t<Work, mpi::together&> at_once(const Work& work) {
    try {
      mpi::together here(MPI_COMM_WORLD);
      return work(here);
    } catch (...) {
      parted_ = true;
      throw;
    }
  }
  bool parted() const { return parted_; }

  std::size_t rank() const { return std::size_t(rank_); }
  std::size_t ranks() const { return std::size_t(ranks_); }

 private:
  int rank_ = 0, ranks_ = 1;
  bool parted_ = false;
};

class robot_of_ranks final : public backend_robot {
 public:
  robot_of_ranks(mpi_ranks& all, std::unique_ptr<backend_robot> mine, const asked_model& asked,
                 const named_values& options)
      : all_(all), mine_(std::move(mine)), asked_(asked) {
    for (const auto& [name, value] : options) alike_.push_back({name, io::digest_of(value)});
    alike_.push_back({"robot", digest_of(*asked.bodies)});
  }

  double see(const std::vector<seen_points>& clouds) override {
    std::vector<seen_points> shares;
    share_.clear(), first_.clear();
    std::vector<std::pair<std::string, io::digest>> seen;
    for (const seen_points& cloud : clouds) {
      std::visit(
          [&](const auto& source) {
            seen.push_back({"cloud " + std::to_string(share_.size()), digest_of(source, cloud.pose)});
            take_share(source);
          },
          cloud.points);
      std::visit(
          [&](auto& mine) {
            mine.pose = cloud.pose;
            shares.push_back({mine.source, cloud.pose});
          },
          share_.back());
    }
    all_.at_once([&](mpi::together& here) {
      auto anywhere = share_;  // poses are compared below, where an option's name is said
      for (auto& its : anywhere) std::visit([](auto& mine) { mine.pose = Eigen::Isometry3d::Identity(); }, its);
      here.agree(asked_.bodies->size(), {}, anywhere);  // the first step of all, also of one that has failed
      compare(alike_);
      compare(seen);
    });
    return mine_->see(shares);
  }
  /// Throws on every rank if one has something else than rank 0. All have as many.
  void compare(const std::vector<std::pair<std::string, io::digest>>& alike) const {
    std::vector<io::digest> mine;
    for (const auto& its : alike) mine.push_back(its.second);
    const std::vector<io::digest> each = mpi::gather(MPI_COMM_WORLD, int(all_.ranks()), mine.data(), mine.size());
    for (std::size_t i = 0; i < each.size(); ++i)
      if (const std::size_t k = i % mine.size(); each[i] != each[k])
        throw std::invalid_argument("rank " + std::to_string(i / mine.size()) + " has another " + alike[k].first +
                                    " than rank 0");
  }

  reply least(poses_of) override { none_of_ranks(); }
  reply least_by(poses_of, double) override { none_of_ranks(); }
  supported_distance supported(poses_of, const min_distance_supported&) override { none_of_ranks(); }
  certain_distance_result certain(poses_of, std::span<const part_radius>) override { none_of_ranks(); }
  unseen_result unseen(poses_of, const clearance::unseen&, bool) override { none_of_ranks(); }
  std::vector<motion_clearance_result> hidden_ways(std::span<const io::joint_motion>, const motion_clearance_options&,
                                                   const clearance::unseen&) override {
    none_of_ranks();
  }

  reply least_per_part(poses_of poses, int repeat) override {
    const auto found = joined<min_distance_per_part>(poses, [&] {
      const reply its = mine_->least_per_part(poses, repeat);
      return min_distance_per_part_result{its.result, its.parts};
    });
    return {found.all, found.parts};
  }
  zones_result zones(poses_of poses, const clearance::zones& options) override {
    return joined<clearance::zones>(poses, [&] { return mine_->zones(poses, options); });
  }
  point_distances distances(poses_of poses, double d_max, bool is_signed) override {
    return joined<clearance::distances>(poses, [&] { return mine_->distances(poses, d_max, is_signed); });
  }
  nearest_k_result nearest(poses_of poses, std::size_t k, double d_max) override {
    return joined<nearest_k>(poses, [&] { return mine_->nearest(poses, k, d_max); });
  }
  self_filter_result own_points(poses_of poses, double padding) override {
    return joined<self_filter>(poses, [&] { return mine_->own_points(poses, padding); });
  }
  std::vector<part_witness> witnesses(poses_of poses, std::span<const part_minimum> minima) override {
    std::vector<part_minimum> own(minima.begin(), minima.end());
    for (part_minimum& its : own) {
      if (its.cloud == none) continue;
      const std::size_t count = std::visit([](const auto& cloud) { return cloud.source.size(); }, share_[its.cloud]);
      its.point -= std::uint32_t(first_[its.cloud]);
      if (its.point >= count) its = {};  // it is another rank's
    }
    return joined(joined_witnesses{}, poses, [&] { return mine_->witnesses(poses, own); });
  }
  min_distances_result plan(poses_of poses, double d_max) override {
    return joined<min_distances>(poses, [&] { return mine_->plan(poses, d_max); });
  }
  min_distances_per_part_result certain_plan(poses_of, double, const std::vector<double>&) override { none_of_ranks(); }
  std::vector<motion_clearance_result> ways(std::span<const io::joint_motion> ways,
                                            const motion_clearance_options& options) override;
  std::span<const part_facts> facts() override { return mine_->facts(); }

 private:
  using placed_points = std::variant<placed<point_span>, placed<depth_image<std::uint16_t>>>;

  void take_share(const point_span& cloud) {
    first_.push_back(first_of_piece(cloud, all_.rank(), all_.ranks()));
    share_.push_back(placed{piece_of(cloud, all_.rank(), all_.ranks())});
  }
  /// One rank has the whole image; the others have no point of it, but its error, as brackets are about all clouds.
  void take_share(const depth_image<std::uint16_t>& image) {
    const bool mine = share_.size() % all_.ranks() == all_.rank();
    first_.push_back(0);
    if (mine) return share_.push_back(placed{image});
    point_span none_of_it;
    none_of_it.off = image.rounding();
    share_.push_back(placed{none_of_it});
  }

  /// This rank's answer about its share, joined with those of all others.
  template <class Joined, class Ask>
  auto joined(Joined answer, poses_of poses, const Ask& ask) -> decltype(answer.result()) {
    return all_.at_once([&](mpi::together& here) {
      here.agree(asked_.bodies->size(), poses, share_);
      decltype(ask()) mine{};
      here.attempt([&] { mine = ask(); });
      here.join(answer, mine);
      query = mine_->query, build = mine_->build, upload = mine_->upload;
      without_field = mine_->without_field, fields = mine_->fields, fields_cached = mine_->fields_cached;
      return answer.result();
    });
  }
  template <class Q, class Ask>
  typename Q::result joined(poses_of poses, const Ask& ask) {
    const std::span<const part_facts> facts;  // none of these answers needs them to be joined
    if (asked_.model == model_kind::spheres)
      return joined(clearance::detail::joined_of<Q, parts_of_spheres>(Q{}, facts), poses, ask);
    return joined(clearance::detail::joined_of<Q, parts_of_triangles>(Q{}, facts), poses, ask);
  }

  [[noreturn]] static void none_of_ranks() { throw std::logic_error("ranks are not asked this"); }

  mpi_ranks& all_;
  std::unique_ptr<backend_robot> mine_;
  asked_model asked_;
  std::vector<std::pair<std::string, io::digest>> alike_;  // what all ranks must have: its name, and its value
  std::vector<placed_points> share_;                       // of each cloud,
  std::vector<std::size_t> first_;                         // and the number of its first point
};

std::vector<motion_clearance_result> robot_of_ranks::ways(std::span<const io::joint_motion> ways,
                                                          const motion_clearance_options& options) {
  const std::span<const part_facts> facts = mine_->facts();
  stopwatch clock;
  std::vector<motion_clearance_result> all;
  const auto ask = [&](poses_of poses) {
    reply found = least_per_part(poses, 1);
    return min_distance_per_part_result{found.result, std::move(found.parts)};
  };
  for (const io::joint_motion& way : ways)
    all.push_back(clearance::detail::over_motion(ask, facts, way, share_, options));
  query = clock.lap();
  return all;
}

std::unique_ptr<backend_robot> mpi_ranks::together(std::unique_ptr<backend_robot> mine, const asked_model& asked,
                                                   const named_values& options) {
  return std::make_unique<robot_of_ranks>(*this, std::move(mine), asked, options);
}

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
