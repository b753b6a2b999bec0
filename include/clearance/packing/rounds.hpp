// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/gap_rounds.hpp>
#include <clearance/packing/limits.hpp>
#include <clearance/packing/round_bodies.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <chrono>
#include <random>

namespace clearance {

/// Packs a mesh solid as `packer` does, but in rounds, for a machine that does much at once: of all cells with nearly
/// the largest key those that are small are climbed from (ProtoSphere's prototypes, Weller & Zachmann 2010), of the
/// spheres found those are taken that conflict with none larger, and the other cells are divided. `Steps` are what a
/// backend does not offer: select(n, f, out), numbers of those for which f holds, in order; largest(n, f), at least 0;
/// and climbers(n, f), which calls f(i, lanes).
template <backend B, class Steps>
class round_packer {
 public:
  round_packer(const B& on, Steps& steps, const mesh_solid& s, const pack_options& options)
      : on_(on),
        steps_(steps),
        solid_(s),
        options_(options),
        limits_(s.bounds(), options),
        there_(s.on(on)),
        rules_(options.gap_per_radius, limits_.smallest) {}

  packing run() {
    packing out;
    out.stopped_by = fill();
    out.room = std::max(limits_.smallest, steps_.largest(alive_, rounds::bound_of{cells_.data(), keys_.data()}));
    const gap_report gap = certify();
    out.gap = gap.certified, out.gap_mean = gap.mean, out.gap_p95 = gap.p95;
    for (const solid_sphere& s : spheres_)
      out.spheres.push_back(
          {{real(s.center.x), real(s.center.y), real(s.center.z)}, real(s.radius)});  // floats: see `fit`
    arrange(out, solid_.volume());
    out.seconds = seconds();
    return out;
  }

 private:
  static constexpr double nearly = 0.9;  // of the largest key; how much is done in a round
  static constexpr std::size_t most_climbers = 8192, most_cells = 1u << 25;  // alive,
  static constexpr std::size_t most_divided = 1u << 22;                                 // and between two spheres

  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  rounds::field field() {
    const box_tree_view tree = {nodes_.data(), order_.data(), tree_.view().items, tree_.view().root};
    return {{there_.view(), spheres_there_.data(), std::uint32_t(spheres_.size()), tree},
            rules_,
            limits_.scale};
  }
  gap_report certify() {
    plant(0);
    return measure_gap(on_, steps_, solid_, field().in, options_.gap_tolerance);
  }

  /// Renews the tree of spheres once more than `most` are not in it.
  void plant(std::size_t most) {
    if (spheres_.size() - tree_.size() <= most) return;
    std::vector<Eigen::AlignedBox3d> boxes;
    for (const solid_sphere& s : spheres_) {
      const Eigen::Vector3d c = s.center, r = Eigen::Vector3d::Constant(s.radius);
      boxes.emplace_back(c - r, c + r);
    }
    tree_ = box_tree(boxes);
    on_.stage(tree_.nodes(), nodes_.reserve(tree_.nodes().size()));
    on_.stage(tree_.order(), order_.reserve(tree_.order().size()));
  }

  /// Ends, because in each round every cell with nearly the largest key is brought up to date (once a cell and sphere), or
  /// divided or given up (half as large, down to `finest`), or offers a sphere; and of those the largest is taken (at most
  /// `count` times). And where very many cells find no sphere it ends, as `packer` does.
  pack_stop fill() {
    std::mt19937_64 random(options_.seed);
    Eigen::Vector3d shift;
    for (int k = 0; k < 3; ++k) shift[k] = options_.seed == 0 ? 0 : double(random() >> 11) * 0x1p-53;
    const cube_grid grid(solid_.bounds(), 8, shift);
    alive_ = grid.size();
    on_.for_each(alive_, rounds::cover{field(), grid, cells_.reserve(alive_), keys_.reserve(alive_)});
    std::size_t tidy_at = 1u << 16;
    stop_check check(options_);
    for (;;) {
      if (const auto why = check(spheres_.size(), [this] { return seconds(); }, [this] { return certify().certified; })) return *why;
      if (alive_ > tidy_at) tidy(), tidy_at = std::max(tidy_at, 2 * alive_);
      if (alive_ > most_cells || divided_ > most_divided) return pack_stop::search_limit;
      while (alive_ > pile_) trust_less(), pile_ += pile_ / 2;
      const double top = steps_.largest(alive_, rounds::key_of{keys_.data()});
      if (!(top > 0)) return limits_.exhausted();
      one_round(nearly * top);
    }
  }

  void one_round(double least) {
    plant(128 + spheres_.size() / 16);
    const rounds::field f = field();
    const std::size_t before = spheres_.size();
    // All of a thin plate's cells have nearly one key. Before they pile up bounds shall be trusted less, and then some go deep.
    const std::size_t room = (pile_ - alive_) / 8 + most_climbers;
    const std::size_t some = std::min(room, steps_.select(alive_, rounds::at_least{keys_.data(), least}, some_.reserve(alive_)));
    on_.for_each(some, rounds::refresh{f, some_.data(), cells_.data(), keys_.data(), least, deeds_.reserve(some)});
    const rounds::is_deed climbing{deeds_.data(), rounds::deed::climb}, dividing{deeds_.data(), rounds::deed::divide};
    const std::size_t climbers = std::min(most_climbers, steps_.select(some, climbing, these_.reserve(some)));
    if (climbers != 0) {
      steps_.climbers(climbers, rounds::climb_cells{f, some_.data(), these_.data(), cells_.data(), keys_.data(),
                                                    options_.allow_overlap, offers_.reserve(climbers), deeds_.data(),
                                                    memory_.reserve(climbers * local_list<one_lane>::capacity)});
      take(climbers);
    }
    const std::size_t divided = steps_.select(some, dividing, these_.data());
    cells_.reserve(alive_ + 8 * divided, alive_), keys_.reserve(alive_ + 8 * divided, alive_);
    on_.for_each(8 * divided,
                 rounds::divide{field(), some_.data(), these_.data(), cells_.data(), keys_.data(), alive_});
    alive_ += 8 * divided;
    divided_ = spheres_.size() > before ? 0 : divided_ + divided;
  }

  void take(std::size_t climbers) {
    on_.for_each(climbers, rounds::judge{offers_.data(), climbers, limits_.scale, verdicts_.reserve(climbers)});
    const std::size_t taken = steps_.select(climbers, rounds::is_taken{verdicts_.data()}, taken_.reserve(climbers));
    on_.for_each(taken,
                 rounds::append{offers_.data(), taken_.data(),
                                spheres_there_.reserve(spheres_.size() + taken, spheres_.size()) + spheres_.size()});
    auto added = on_.copy_out(spheres_there_.data() + spheres_.size(), taken);
    if (spheres_.size() + taken > options_.count) {  // the last round: the largest
      std::stable_sort(added.begin(), added.end(), [](const auto& a, const auto& b) { return a.radius > b.radius; });
      added.resize(options_.count - spheres_.size());
      on_.stage(std::span<const solid_sphere>(added), spheres_there_.data() + spheres_.size());
    }
    spheres_.insert(spheres_.end(), added.begin(), added.end());
  }

  void tidy() {
    const std::size_t kept = steps_.select(alive_, rounds::is_kept{keys_.data()}, some_.reserve(alive_));
    growing<rounds::cell, B> cells(on_);
    growing<double, B> keys(on_);
    on_.for_each(kept, rounds::keep_cells{some_.data(), cells_.data(), keys_.data(), cells.reserve(2 * kept),
                                          keys.reserve(2 * kept)});
    std::swap(cells, cells_), std::swap(keys, keys_);
    alive_ = kept;
  }
  void trust_less() {
    rules_.trust *= 0.6;
    on_.for_each(alive_, rounds::weigh_again{field(), cells_.data(), keys_.data()});
  }

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  B on_;
  Steps& steps_;
  const mesh_solid& solid_;
  const pack_options& options_;
  pack_limits limits_;
  mesh_solid_copy<B> there_;
  box_tree tree_;
  growing<box_pair, B> nodes_{on_};
  std::vector<solid_sphere> spheres_;
  growing<solid_sphere, B> spheres_there_{on_};
  growing<rounds::cell, B> cells_{on_};
  growing<double, B> keys_{on_};
  growing<std::uint32_t, B> order_{on_}, some_{on_}, these_{on_}, taken_{on_}, memory_{on_};
  growing<rounds::deed, B> deeds_{on_};
  growing<rounds::offer, B> offers_{on_};
  growing<unsigned char, B> verdicts_{on_};
  std::size_t pile_ = 1u << 22;
  std::size_t alive_ = 0, divided_ = 0;  // cells, and those divided since the last sphere
  pack_rules rules_;
};

}  // namespace clearance
