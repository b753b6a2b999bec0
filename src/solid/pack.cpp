// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/packing/pack.hpp>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearance {

std::string packing::reason() const {
  const auto mm = [](double metres) { return std::to_string(metres * 1000) + " mm"; };
  switch (stopped_by) {
    case pack_stop::count:
      return "the number of spheres was reached";
    case pack_stop::no_room:
      return "no further sphere larger than 1e-6 of the solid fits";
    case pack_stop::smallest_radius:
      return "no further sphere as large as the smallest radius fits";
    case pack_stop::gap:
      return "the gap target was reached";
    case pack_stop::time:
      return "the time was up";
    case pack_stop::cancelled:
      return "it was cancelled";
    case pack_stop::search_limit:
      return "the search for room grew too large; a further sphere is smaller than " + mm(room);
  }
  return {};
}

pack_limits::pack_limits(const Eigen::AlignedBox3d& box, const pack_options& options) {
  if (box.isEmpty() || !(box.diagonal().norm() > 0) || !std::isfinite(box.diagonal().norm()))
    throw std::invalid_argument("clearance::pack: the solid's bounds are empty or not finite");
  for (const double x : {options.smallest_radius, options.gap_target, options.seconds})
    if (!(x >= 0))
      throw std::invalid_argument("clearance::pack: smallest_radius, gap_target and seconds must not be negative");
  if (!(options.gap_per_radius > 0)) throw std::invalid_argument("clearance::pack: gap_per_radius must be positive");
  if (!(options.gap_tolerance > 0)) throw std::invalid_argument("clearance::pack: gap_tolerance must be positive");
  scale = box.diagonal().norm() + box.center().norm();
  least_room = 1e-6 * box.diagonal().norm();
  smallest = std::max(options.smallest_radius, least_room);
}

void arrange(packing& p, double volume) {
  std::stable_sort(p.spheres.begin(), p.spheres.end(),
                   [](const auto& a, const auto& b) { return a.radius > b.radius; });
  if (!p.spheres.empty()) {
    p.radius_max = p.spheres.front().radius;
    p.radius_min = p.spheres.back().radius;
  }
  for (const inner_sphere& s : p.spheres) p.fill += 4.0 / 3 * std::numbers::pi * std::pow(double(s.radius), 3) / volume;
}

void for_each_packing(std::size_t n, unsigned threads, const std::function<void(std::size_t)>& f) {
  const auto all = [&] {
    // They get their own context: if the caller's tasks were cancelled, loops inside would do nothing, and a packing
    // would never end.
    tbb::task_group_context own(tbb::task_group_context::isolated);
    // A thread that waits in a packing must not begin another, which would hold up the first.
    const auto one = [&](std::size_t i) { tbb::this_task_arena::isolate([&] { f(i); }); };
    tbb::parallel_for(std::size_t(0), n, one, tbb::simple_partitioner{}, own);
  };
  if (threads == 0) return all();
  tbb::task_arena arena(int(threads), 1);
  arena.execute(all);
}

namespace {

/// One set of options for several packings at once. One thread at a time calls its functions, progress is the total,
/// and cancelling cancels all.
class shared_pack_options {
 public:
  shared_pack_options(const pack_options& options, std::size_t packings)
      : options_(options),
        of_(options.count > std::numeric_limits<std::size_t>::max() / packings ? std::numeric_limits<std::size_t>::max()
                                                                               : options.count * packings),
        done_(packings, 0) {}

  /// Options for packing i. It uses the threads of the place where it runs.
  pack_options one(std::size_t i) {
    pack_options own = options_;
    own.threads = 0;
    if (options_.progress) own.progress = [this, i](std::size_t done, std::size_t) { report(i, done); };
    own.cancelled = [this] { return stopped_ || (options_.cancelled && asked()); };
    return own;
  }
  void finished(std::size_t i) {
    const std::lock_guard alone(mutex_);
    done_[i] = options_.count;
  }
  void stop() { stopped_ = true; }

 private:
  void report(std::size_t i, std::size_t done) {
    const std::lock_guard alone(mutex_);
    done_[i] = done;
    std::size_t sum = 0;
    for (const std::size_t each : done_) sum += std::min(each, of_ - sum);
    options_.progress(sum, of_);
  }
  bool asked() {
    const std::lock_guard alone(mutex_);
    if (!stopped_ && options_.cancelled()) stopped_ = true;
    return stopped_;
  }

  const pack_options& options_;
  const std::size_t of_;
  std::vector<std::size_t> done_;  // by packing; `count` once it has finished, however few it made
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
};

}  // namespace

void make_side_by_side(std::size_t n, const pack_options& options,
                       const std::function<void(std::size_t, const pack_options&)>& make) {
  if (n == 0) return;
  shared_pack_options shared(options, n);
  std::vector<std::exception_ptr> errors(n);
  for_each_packing(n, options.threads, [&](std::size_t i) {
    try {
      make(i, shared.one(i));
      shared.finished(i);
    } catch (...) {
      errors[i] = std::current_exception();
      shared.stop();
    }
  });
  for (std::size_t i = 0; i < n; ++i) {
    if (!errors[i]) continue;
    try {
      std::rethrow_exception(errors[i]);
    } catch (const std::invalid_argument& error) {
      throw solid_error(i, error.what());
    }
  }
}

packing pack(const mesh_solid& s, const pack_options& options) { return pack<mesh_solid>(s, options); }
packing pack(const triangle_mesh& mesh, const pack_options& options) { return pack(mesh_solid(mesh), options); }

gap_report measure_gap(const mesh_solid& s, std::span<const inner_sphere> spheres, double tolerance) {
  return measure_gap<mesh_solid>(s, spheres, tolerance);
}

}  // namespace clearance
