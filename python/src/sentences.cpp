// SPDX-License-Identifier: BSD-3-Clause
#include "sentences.hpp"

#include "declared.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

using namespace clearance;

namespace {

std::string grouped(std::uint64_t n) {
  std::string text = std::to_string(n);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

std::string counted(std::uint64_t n, const std::string& what) { return grouped(n) + ' ' + what + (n == 1 ? "" : "s"); }

std::string metres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", std::abs(value) < 0.0005 ? 0 : value);  // not -0.000
  return text;
}

std::string part_name(std::uint32_t part, const part_names& names) {
  return names && part < names->size() ? (*names)[part] : "part " + std::to_string(part);
}

/// ", hand to point 84,612"; "" without a part.
std::string pair_of(std::uint32_t part, std::uint32_t cloud, std::uint32_t point, const part_names& names) {
  if (part == none) return "";
  return ", " + part_name(part, names) + " to " + (cloud != 0 ? "cloud " + std::to_string(cloud) + ", " : "") +
         "point " + grouped(point);
}

std::string bracket(double lower, double upper) {
  return " (certainly " + metres(lower) + (upper < infinity ? " to " + metres(upper) : " or more") + ")";
}

std::string no_data(std::uint64_t seen) {
  return std::string(to_string(state::no_data)) + ": none of " + counted(seen, "point") + " is valid";
}

/// The least of some configurations' results, each of `parts` of them.
std::string least_of(std::span<const min_distance_result> all, std::size_t parts, const part_names& names) {
  const std::size_t configurations = parts == 0 ? 0 : all.size() / parts;
  std::string text = counted(configurations, "configuration");
  const auto nearer = [](const auto& a, const auto& b) { return a.distance < b.distance; };  // NaN is none
  const min_distance_result* least = nullptr;
  for (const auto& r : all)
    if (r.state != state::no_data && (!least || nearer(r, *least))) least = &r;
  if (!least) return text + (all.empty() ? "" : ": no valid point");
  return text + ", the nearest is number " + grouped(std::size_t(least - all.data()) / parts) + ": " +
         sentence_of(*least, names);
}

std::string least_of(std::span<const real> distances, const point_counts& counts) {
  real least = infinity;
  for (const real d : distances)
    if (d < least) least = d;  // NaN is none
  return "distances of " + counted(counts.valid, "valid point") +
         (least < infinity ? ", the least " + metres(least) + " m" : "");
}

}  // namespace

std::string sentence_of(const min_distance_result& r, const part_names& names) {
  if (r.state == state::no_data) return no_data(r.seen);
  char text[96];
  std::snprintf(text, sizeof text, ": %s m (certainly %.3f to %.3f)", metres(r.distance).c_str(), double(r.lower),
                double(r.upper));
  return to_string(r.state) + std::string(text) + pair_of(r.part, r.cloud, r.point, names);
}

std::string sentence_of(const self_clearance& r, const part_names& names) {
  if (r.a == none) return to_string(r.state) + std::string(": no pair of parts can meet");
  return to_string(r.state) + (": " + metres(r.distance) + " m") + bracket(r.lower, r.upper) + ", " +
         part_name(r.a, names) + " to " + part_name(r.b, names);
}

std::string sentence_of(const min_distance_per_part_result& r, const part_names& names) {
  return sentence_of(r.all, names) + "; of " + counted(r.parts.size(), "part");
}

std::string sentence_of(const min_distances_result& r, const part_names& names) { return least_of(r.of, 1, names); }

std::string sentence_of(const min_distances_per_part_result& r, const part_names& names) {
  return least_of(r.all, r.parts, names);
}

std::string sentence_of(const certain_distance_result& r, const part_names& names) {
  if (r.state == state::no_data) return no_data(r.nominal.seen);
  return std::string(to_string(r.state)) + ": measured " + metres(r.nominal.distance) + " m" +
         bracket(r.lower, r.upper) + pair_of(r.certain.part, r.certain.cloud, r.certain.point, names);
}

std::string sentence_of(const collision_result& r, const part_names& names) {
  if (r.state == state::no_data) return no_data(r.counts.seen);
  return to_string(r.state) + (r.part == none
                                   ? ": of " + counted(r.counts.valid, "valid point") + " none is within the margins"
                                   : ": " + pair_of(r.part, r.cloud, r.point, names).substr(2));
}

std::string sentence_of(const in_collisions_result& r, const part_names&) {
  std::string text = counted(r.of.size(), "configuration");
  const char* before = ": ";
  for (const state each : {state::free, state::possible, state::collision, state::no_data, state::unknown})
    if (const auto n = std::ranges::count(r.of, each); n != 0) {
      text += before + grouped(std::uint64_t(n)) + ' ' + to_string(each);
      before = ", ";
    }
  return text;
}

std::string sentence_of(const supported_distance& r, const part_names& names) {
  if (r.state == state::no_data) return no_data(r.counts.seen);
  const std::string isolated = "; " + counted(r.isolated, "nearer point") + " not confirmed";
  if (r.part == none) return std::string(to_string(r.state)) + ": no point is confirmed" + isolated;
  return std::string(to_string(r.state)) + ": " + metres(r.distance) + " m" + bracket(r.lower, infinity) +
         pair_of(r.part, r.cloud, r.point, names) + isolated;
}

std::string sentence_of(const unseen_result& r, const part_names& names) {
  if (r.all.state == state::no_data)
    return std::string(to_string(r.all.state)) + ": none of " + counted(r.all.seen, "pixel") + " hides room";
  return "unseen room is " + std::string(to_string(r.all.state)) + ": " + metres(r.all.distance) + " m" +
         bracket(r.all.lower, r.all.upper) + (r.all.part == none ? "" : ", " + part_name(r.all.part, names));
}

std::string sentence_of(const seen_and_unseen_result& r, const part_names& names) {
  return "seen: " + sentence_of(r.seen, names) + "; " + sentence_of(static_cast<const unseen_result&>(r), names);
}

std::string sentence_of(const motion_clearance_result& r, const part_names& names) {
  if (r.state == state::no_data) return no_data(r.nearest.seen);
  char when[64];
  std::snprintf(when, sizeof when, ", nearest at time %.3f", r.time);
  return std::string(to_string(r.state)) + ": over the motion certainly " + metres(r.lower) + " m or more" + when +
         pair_of(r.nearest.part, r.nearest.cloud, r.nearest.point, names) +
         (r.settled ? "" : "; the queries were used up");
}

std::string sentence_of(const zones_result& r, const part_names&) {
  const std::size_t zone = r.innermost();
  if (r.counts.valid == 0) return "zone 0, because nothing is known: " + no_data(r.counts.seen);
  if (zone == r.per_part) return "no zone of " + std::to_string(r.per_part) + " is entered";
  std::uint64_t points = 0;
  for (std::size_t i = zone; i < r.zones.size(); i += r.per_part) points += r.zones[i].points;
  return "zone " + std::to_string(zone) + " of " + std::to_string(r.per_part) +
         " is entered: " + counted(points, "point");
}

std::string sentence_of(const within_result& r, const part_names&) {
  return counted(r.pairs.size(), "pair") + " within the radius, of " + counted(r.counts.valid, "valid point");
}

std::string sentence_of(const nearest_k_result& r, const part_names&) {
  return "the nearest " + counted(r.pairs.size(), "pair") + ", at most " + std::to_string(r.per_part) + " a part, of " +
         counted(r.counts.valid, "valid point");
}

std::string sentence_of(const point_distances& r, const part_names&) { return least_of(r.distance, r.counts); }

std::string sentence_of(const part_distances& r, const part_names&) {
  return least_of(r.distance, r.counts) + ", from each of " + counted(r.parts, "part");
}

std::string sentence_of(const self_filter_result& r, const part_names&) {
  return grouped(r.counts.own) + " of " + counted(r.counts.points.valid, "valid point") + " are the robot's own, " +
         grouped(r.counts.uncertain) + " uncertain";
}

std::string sentence_of(const point_counts& r, const part_names&) {
  std::string text = grouped(r.valid) + " of " + counted(r.seen, "point") + " valid";
  const auto add = [&](const char* name, drop_reason reason) {
    if (const auto n = r.dropped[int(reason)]; n != 0) text += ", " + grouped(n) + ' ' + name;
  };
  std::apply([&](const auto&... v) { (add(v.name, v.value), ...); }, declared<drop_reason>::values);
  return text;
}
