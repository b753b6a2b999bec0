// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What you ask of packing, and what you get: spheres, and what is certain about them.

#include <clearance/primitive/inner_sphere.hpp>

#include <functional>
#include <string>

namespace clearance {

struct pack_options {
  std::size_t count = 2048;    ///< The most spheres to place.
  double smallest_radius = 0;  ///< Metres; never below 1e-6 of the solid's diagonal, which is also the default.
  double gap_target = 0;       ///< Metres: stop once the certified gap is at most this. 0: never.
  double seconds = 0;          ///< Stop after about this time. 0: no limit. Results with a limit are not repeatable.
  std::uint64_t seed = 0;      ///< Another seed gives another packing, equally good.
  unsigned threads = 0;        ///< 0: TBB decides. The result does not depend on it.
  /// A place farther from the spheres than this many times the next radius gets a smaller sphere before its turn, so
  /// that thin walls and sharp corners do not decide the gap. Infinity: strictly the largest first.
  double gap_per_radius = 1.6;
  bool allow_overlap = false;   ///< Let spheres overlap: fewer of them reach the same gap.
  double gap_tolerance = 0.01;  ///< The certified gap exceeds the true gap by at most this part (or 10 um, if more).
  /// Called now and then from the calling thread; if several solids are packed at once, from any, one call at a time.
  std::function<void(std::size_t done, std::size_t of)> progress = {};
  std::function<bool()> cancelled = {};  ///< Called as `progress`; true: stop, and keep what there is.
};

enum class pack_stop : std::uint8_t { count, no_room, smallest_radius, gap, time, cancelled, search_limit };

/// Inner spheres of a solid, and what is known about them. All lengths in metres.
struct packing {
  std::vector<inner_sphere> spheres;  ///< Largest first; inside the solid and apart from one another, in double.
  /// Certified: no point of the solid, surface and interior, is farther from the spheres.
  double gap = 0;
  double tolerance = 0;              ///< Within this distance of the surface it is uncertain what is inside.
  double gap_mean = 0, gap_p95 = 0;  ///< Mean and 95th percentile over samples of the surface; 0 if there are none.
  double fill = 0;                   ///< Total volume of the spheres over the solid's; overlaps count repeatedly.
  double radius_min = 0, radius_max = 0;
  double room = 0;  ///< Certified: no further sphere that fits is larger than this.
  pack_stop stopped_by = pack_stop::count;
  double seconds = 0;

  /// The reason why packing stopped, as one clause for a person.
  std::string reason() const;
};

}  // namespace clearance
