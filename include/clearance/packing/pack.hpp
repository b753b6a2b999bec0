// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Packs spheres into a solid, the largest first, or into several solids side by side.

#include <clearance/packing/gap.hpp>
#include <clearance/packing/packing.hpp>
#include <clearance/packing/round_bodies.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <ranges>
#include <stdexcept>
#include <type_traits>

namespace clearance {

/// Lengths that follow from a solid's size and the options, in metres.
struct pack_limits {
  double scale;       ///< For rounding errors: no coordinate is larger.
  double least_room;  ///< No smaller sphere is searched for, whatever the options say.
  double smallest;    ///< The least radius.

  /// Throws std::invalid_argument for options or bounds that make no sense.
  pack_limits(const Eigen::AlignedBox3d& box, const pack_options& options);

  /// Why there is nothing left to divide.
  pack_stop exhausted() const { return smallest > least_room ? pack_stop::smallest_radius : pack_stop::no_room; }
};

/// Called between spheres: reports progress, and returns a reason to stop, if there is one. The certified gap is slow,
/// so it is computed only after every quarter more spheres.
class stop_check {
 public:
  explicit stop_check(const pack_options& options) : options_(options) {}

  template <class Seconds, class Gap>
  std::optional<pack_stop> operator()(std::size_t spheres, Seconds seconds, Gap certified) {
    if (spheres >= options_.count) return pack_stop::count;
    if (options_.progress) options_.progress(spheres, options_.count);
    if (options_.cancelled && options_.cancelled()) return pack_stop::cancelled;
    if (options_.seconds > 0 && seconds() > options_.seconds) return pack_stop::time;
    if (!(options_.gap_target > 0) || spheres < gap_asked_at_) return {};
    gap_asked_at_ = spheres + spheres / 4;
    if (certified() <= options_.gap_target) return pack_stop::gap;
    return {};
  }

 private:
  const pack_options& options_;
  std::size_t gap_asked_at_ = 32;
};

/// Sorts the spheres and computes the totals.
void arrange(packing& p, double volume);

/// Fills a solid with spheres, the largest first. The room at a point is its distance to the surface and to the spheres
/// so far. Between two points it changes by at most their distance, so in a cube it is at most that of the middle plus
/// half the diagonal (branch and bound on ProtoSphere's field, Weller & Zachmann 2010). It works in rounds, for
/// machines that do much at once. A round takes all cubes with nearly the largest bound. It climbs from those that are
/// small against their room, keeps those spheres that conflict with no larger one, and divides the other cubes.
///
/// `Steps` adds what a backend does not offer: each(n, f), where one f takes long; eighths(n, f), which calls f(i) for
/// 8n numbers, or f.all_eight(i) for n, if i .. i + 7 are the eighths of one cube; climbers(n, f), which calls f(i,
/// lanes); select(n, f, out), numbers for which f holds, in order; largest(n, f), at least 0; next(keys, n, most, out,
/// least), at most `most` numbers of cells with nearly the largest keys, positive and at least `least`, none if there
/// are none; forget(), after a change of other cells' keys; and `cells`, how many may exist before they pile up.
template <backend B, class Steps, solid_for<B> S>
class packer {
 public:
  packer(const B& on, Steps& steps, const S& s, const pack_options& options)
      : on_(on),
        steps_(steps),
        solid_(s),
        options_(options),
        limits_(s.bounds(), options),
        there_(on, s),
        rules_(options.gap_per_radius, limits_.smallest) {}

  packing run() {
    packing out;
    out.stopped_by = fill();
    out.room = std::max(limits_.smallest, steps_.largest(alive_, rounds::bound_of{cells_.data(), keys_.data()}));
    const gap_report gap = certify();
    out.gap = gap.certified;
    out.gap_mean = gap.mean;
    out.gap_p95 = gap.p95;
    for (const solid_sphere& s : spheres_.here())
      out.spheres.push_back(
          {{real(s.center.x), real(s.center.y), real(s.center.z)}, real(s.radius)});  // floats, as `fit` made them
    if constexpr (requires { solid_.tolerance(); }) out.tolerance = solid_.tolerance();
    double volume = double(infinity);
    if constexpr (requires { solid_.volume(); }) volume = solid_.volume();
    arrange(out, volume);
    out.seconds = seconds();
    return out;
  }

 private:
  using view_type = decltype(std::declval<const solid_there<B, S>&>().view());
  static constexpr std::size_t most_climbers = 8192;
  static constexpr std::size_t most_cells = 8 * Steps::cells;  // that exist,
  static constexpr std::size_t most_divided = Steps::cells;    // and are divided between two spheres

  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  rounds::field<view_type> field() { return {spheres_.room_in(there_.view()), rules_, limits_.scale}; }
  gap_report certify() {
    spheres_.plant(0);
    return measure_gap(on_, steps_, solid_, field().in, options_.gap_tolerance);
  }

  /// Ends, because every round does something to each cell whose turn it is, and nothing happens forever. The cell is
  /// updated (once per sphere), divided or given up (half as large, down to `finest`), or offers a sphere; the largest
  /// offer is taken (at most `count` times). A plate thinner than any sphere searched for would have 1e12 cells, so the
  /// search also ends after too many cells without a sphere.
  pack_stop fill() {
    std::mt19937_64 random(options_.seed);
    Eigen::Vector3d shift;
    for (int k = 0; k < 3; ++k) shift[k] = options_.seed == 0 ? 0 : double(random() >> 11) * 0x1p-53;
    const cube_grid grid(solid_.bounds(), 8, shift);
    alive_ = grid.size();
    steps_.each(alive_, rounds::cover<view_type>{field(), grid, cells_.reserve(alive_), keys_.reserve(alive_)});
    std::size_t tidy_at = 1u << 16;
    stop_check check(options_);
    for (;;) {
      if (const auto why = check(spheres_.size(), [this] { return seconds(); }, [this] { return certify().certified; }))
        return *why;
      if (alive_ > std::min(tidy_at, pile_)) {
        tidy();
        tidy_at = std::max(tidy_at, alive_ + alive_ / 2);
        while (alive_ > pile_ - pile_ / 8) {
          trust_less();
          pile_ += pile_ / 2;  // if fewer are removed, they are soon back
        }
      }
      if (alive_ > most_cells || divided_ > most_divided) return pack_stop::search_limit;
      // All cells of a thin plate have nearly one key. Before they pile up, bounds are trusted less, so some cells go
      // deep.
      const std::size_t room = (pile_ - alive_) / 8 + most_climbers;
      double least;
      const std::size_t some = steps_.next(keys_.data(), alive_, room, some_.reserve(alive_), least);
      if (some == 0) return limits_.exhausted();
      one_round(some, least);
    }
  }

  void one_round(std::size_t some, double least) {
    spheres_.plant(128 + spheres_.size() / 16);
    const rounds::field<view_type> f = field();
    const std::size_t before = spheres_.size();
    steps_.each(some, rounds::refresh<view_type>{f, some_.data(), some, cells_.data(), keys_.data(), least,
                                                 deeds_.reserve(some)});
    const rounds::is_deed climbing{deeds_.data(), rounds::deed::climb}, dividing{deeds_.data(), rounds::deed::divide};
    const std::size_t climbers = std::min(most_climbers, steps_.select(some, climbing, these_.reserve(some)));
    if (climbers != 0) {
      steps_.climbers(climbers, rounds::climb_cells<view_type>{
                                    .f = f,
                                    .some = some_.data(),
                                    .these = these_.data(),
                                    .cells = cells_.data(),
                                    .keys = keys_.data(),
                                    .overlap = options_.allow_overlap,
                                    .offers = offers_.reserve(climbers),
                                    .deeds = deeds_.data(),
                                    .memory = memory_.reserve(climbers * local_list<view_type, one_lane>::capacity)});
      place_spheres(climbers);
    }
    const std::size_t divided = steps_.select(some, dividing, these_.data());
    cells_.reserve(alive_ + 8 * divided, alive_);
    keys_.reserve(alive_ + 8 * divided, alive_);
    steps_.eighths(
        divided, rounds::divide<view_type>{field(), some_.data(), these_.data(), cells_.data(), keys_.data(), alive_});
    alive_ += 8 * divided;
    divided_ = spheres_.size() > before ? 0 : divided_ + divided;
  }

  void place_spheres(std::size_t climbers) {
    steps_.each(climbers, rounds::judge{offers_.data(), climbers, limits_.scale, verdicts_.reserve(climbers)});
    std::size_t taken = steps_.select(climbers, rounds::is_taken{verdicts_.data()}, taken_.reserve(climbers));
    if (const std::size_t wanted = options_.count - spheres_.size();
        taken > wanted) {  // the last round: earlier turns first
      const auto offers = on_.copy_out(offers_.data(), climbers);
      auto which = on_.copy_out(taken_.data(), taken);
      std::stable_sort(which.begin(), which.end(), [&](auto i, auto j) { return offers[i].key > offers[j].key; });
      on_.stage(std::span<const std::uint32_t>(which).first(taken = wanted), taken_.data());
    }
    solid_sphere* const to = spheres_.reserve(taken);
    on_.for_each(taken, rounds::append{offers_.data(), taken_.data(), to});
    spheres_.add(on_.copy_out(to, taken));
  }

  void tidy() {
    const std::size_t kept = steps_.select(alive_, rounds::is_kept{keys_.data()}, some_.reserve(alive_));
    on_.for_each(kept, rounds::keep_cells{some_.data(), cells_.data(), keys_.data(), other_cells_.reserve(kept),
                                          other_keys_.reserve(kept)});
    std::swap(cells_, other_cells_);
    std::swap(keys_, other_keys_);
    alive_ = kept;
    steps_.forget();
  }
  void trust_less() {
    rules_.trust *= 0.6;
    on_.for_each(alive_, rounds::weigh_again<view_type>{field(), cells_.data(), keys_.data()});
    steps_.forget();
  }

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  B on_;
  Steps& steps_;
  const S& solid_;
  const pack_options& options_;
  pack_limits limits_;
  solid_there<B, S> there_;
  spheres_there<B> spheres_{on_};
  growing<rounds::cell, B> cells_{on_}, other_cells_{on_};  // others: for cells that are kept
  growing<double, B> keys_{on_}, other_keys_{on_};
  growing<std::uint32_t, B> some_{on_}, these_{on_}, taken_{on_}, memory_{on_};
  growing<rounds::deed, B> deeds_{on_};
  growing<rounds::offer, B> offers_{on_};
  growing<unsigned char, B> verdicts_{on_};
  std::size_t pile_ = Steps::cells;
  std::size_t alive_ = 0, divided_ = 0;  // cells; those divided since the last sphere
  pack_rules rules_;
};

/// Reports what is wrong with one of several solids or meshes: its index from 0, and what() as if it were alone.
struct solid_error : std::invalid_argument {
  std::size_t index;
  solid_error(std::size_t i, const char* what) : std::invalid_argument(what), index(i) {}
};

/// Calls f(0) .. f(n-1) once each, on `threads` threads of TBB (0: TBB decides); for n = 1 from this thread.
void for_each_packing(std::size_t n, unsigned threads, const std::function<void(std::size_t)>& f);

/// Calls `make(i, options)` for i = 0 .. n-1: packings side by side, on `options.threads` threads in all. If some
/// throw, the others are cancelled, and the error of the lowest i is thrown, a std::invalid_argument as solid_error.
void make_side_by_side(std::size_t n, const pack_options& options,
                       const std::function<void(std::size_t, const pack_options&)>& make);
/// The same, and what they return.
template <class Make>
auto side_by_side(std::size_t n, const pack_options& options, const Make& make) {
  std::vector<std::invoke_result_t<const Make&, std::size_t, const pack_options&>> made(n);
  make_side_by_side(n, options, [&](std::size_t i, const pack_options& own) { made[i] = make(i, own); });
  return made;
}

/// Packs spheres into a solid. The same options and seed give the same packing on any number of threads. Throws
/// std::invalid_argument for options or bounds that make no sense. Link clearance::solid.
template <solid S>
packing pack(const S& s, const pack_options& options = {}) {
  packing made;
  for_each_packing(1, options.threads, [&](std::size_t) {
    const host on;
    host_steps steps(on);
    made = packer<host, host_steps, S>(on, steps, s, options).run();
  });
  return made;
}

/// The same for a mesh, compiled once.
packing pack(const mesh_solid& s, const pack_options& options = {});
/// Closes the mesh first; throws std::invalid_argument if it has no inside.
packing pack(const triangle_mesh& mesh, const pack_options& options = {});

/// A range of solids, or of meshes.
template <class R>
concept packable_range =
    std::ranges::random_access_range<R> && std::ranges::sized_range<R> &&
    (solid<std::ranges::range_value_t<R>> || std::constructible_from<mesh_solid, std::ranges::range_reference_t<R>>);

/// Calls `make(solid, options)` for several solids, or for the solids in meshes, side by side.
template <class R, class Make>
  requires packable_range<const R>
std::vector<packing> pack_each(const R& solids, const pack_options& options, const Make& make) {
  const auto first = std::ranges::begin(solids);
  return side_by_side(std::size_t(std::ranges::size(solids)), options, [&](std::size_t i, const pack_options& own) {
    decltype(auto) element = first[std::ranges::range_difference_t<const R>(i)];
    if constexpr (solid<std::ranges::range_value_t<R>>)
      return make(element, own);
    else
      return make(mesh_solid(element), own);
  });
}

/// Packs several solids side by side, such as a robot's links: the same packings as one by one, sooner. `seconds`
/// applies to each; `progress` counts all spheres. Each element is read once, from any thread. Throws solid_error for
/// the first bad one.
template <class R>
  requires packable_range<const R>
std::vector<packing> pack(const R& solids, const pack_options& options = {}) {
  return pack_each(solids, options, [](const auto& s, const pack_options& own) { return pack(s, own); });
}

}  // namespace clearance
