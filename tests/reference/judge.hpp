// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks the library every question about a scene, and compares each answer with what the reference says of it.

#include "reference/solid.hpp"

#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/hidden.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/min_distance_filtered.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>

#include <cstdio>
#include <string>

namespace reference {

/// Cases and how many were wrong, by question; the first that was is told.
class tally {
 public:
  void add(const std::string& question, std::uint64_t cases) { counts_[question].first += cases; }
  template <class... Words>
  void require(bool holds, const std::string& question, const char* format, Words... words) {
    ++counts_[question].first;
    if (holds) return;
    char text[256];
    std::snprintf(text, sizeof text, format, words...);
    if (counts_[question].second++ < 3) first_ += question + ": " + about + ": " + text + "\n";
  }
  const auto& counts() const { return counts_; }
  const std::string& first() const { return first_; }
  std::uint64_t wrong() const {
    std::uint64_t all = 0;
    for (const auto& [question, its] : counts_) all += its.second;
    return all;
  }

  std::string about;  ///< What is asked about now.

 private:
  std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> counts_;
  std::string first_;
};

/// What the reference knows of a part: its solid, and its spheres if it is one of those.
struct body {
  const solid* its;
  std::vector<clearance::inner_sphere> spheres;
};

/// A model, its bodies in the same order, and poses world-from-part.
template <class Model>
struct scene {
  const Model& model;
  const std::vector<body>& bodies;
  const std::vector<Eigen::Isometry3d>& poses;
};

inline place moved(const Eigen::Isometry3d& m, place p) {
  const auto row = [&](int k) {
    return wide(m(k, 0)) * p.x + wide(m(k, 1)) * p.y + wide(m(k, 2)) * p.z + wide(m(k, 3));
  };
  return {row(0), row(1), row(2)};
}
inline place moved_back(const Eigen::Isometry3d& m, place p) {
  const place d{p.x - wide(m(0, 3)), p.y - wide(m(1, 3)), p.z - wide(m(2, 3))};
  const auto column = [&](int k) { return wide(m(0, k)) * d.x + wide(m(1, k)) * d.y + wide(m(2, k)) * d.z; };
  return {column(0), column(1), column(2)};
}

template <class Model>
class judge {
 public:
  using view = typename Model::view_type;
  static constexpr bool signs = std::is_same_v<typename view::hierarchy_type::primitive_type, clearance::inner_sphere>;

  judge(const scene<Model>& s, std::span<const clearance::vec3> points, const Eigen::Isometry3d& cloud, tally& t)
      : s_(s), points_(points), cloud_(cloud), t_(t), parts_(s.bodies.size()) {
    look();
    each_point(), least(), many(), lists(), labels();
  }

 private:
  /// A pair's distance to the primitives and to the surface, and the error that the documents state of it. To the solid
  /// it is not above `low` and not below `high`, which differ where the inside is unknown.
  struct pair {
    wide distance, low, high, error, surface;
    side where;
  };
  const pair& at(std::size_t part, std::size_t point) const { return pairs_[part * points_.size() + point]; }
  const clearance::part_facts& facts(std::size_t part) const { return s_.model.parts()[part].facts; }
  wide slop(std::size_t part) const { return wide(facts(part).gap) + wide(facts(part).tolerance); }

  void look() {
    for (std::size_t k = 0; k < parts_; ++k) {
      const solid& its = *s_.bodies[k].its;
      const place start = moved_back(s_.poses[k], moved(cloud_, {0, 0, 0}));
      const wide size = length(wider<wide>(facts(k).center)) + wide(facts(k).radius);
      const wide ways = cloud_.translation().norm() * 2 + s_.poses[k].translation().norm();
      for (const clearance::vec3 p : points_) {
        const place q = moved_back(s_.poses[k], moved(cloud_, wider<wide>(p)));
        pair a;
        // An origin near the robot is subtracted from a cloud, so the way between frames is that to the origin.
        a.error = 0x1p-20L * (length(q) + std::min(length(start), wide(64)) + size) + 0x1p-44L * ways + 0x1p-72L;
        a.surface = its.surface(q), a.where = its.where(q);
        a.low = a.where == side::inside ? 0 : a.surface, a.high = a.where == side::outside ? a.surface : 0;
        a.distance = a.where == side::inside ? 0 : a.surface;
        if constexpr (signs) {
          a.distance = std::numeric_limits<wide>::infinity();
          for (const auto& ball : s_.bodies[k].spheres)
            a.distance = std::min(a.distance, length(q - wider<wide>(ball.center)) - wide(ball.radius));
        }
        pairs_.push_back(a);
      }
    }
    const wide nothing = std::numeric_limits<wide>::infinity();
    least_.assign(points_.size(), nothing), error_.assign(points_.size(), 0);
    for (std::size_t k = 0; k < parts_; ++k)
      for (std::size_t i = 0; i < points_.size(); ++i) {
        least_[i] = std::min(least_[i], lowest(k, i)), error_[i] = std::max(error_[i], at(k, i).error);
        nearest_ = std::min(nearest_, lowest(k, i)), solid_low_ = std::min(solid_low_, at(k, i).low);
        solid_high_ = std::min(solid_high_, at(k, i).high), most_error_ = std::max(most_error_, at(k, i).error);
      }
  }
  /// Where the inside is unknown, a part of triangles may say 0, or the distance of its surface or of a cap.
  bool unknown(std::size_t k, std::size_t i) const { return !signs && at(k, i).where == side::unknown; }
  wide lowest(std::size_t k, std::size_t i) const { return unknown(k, i) ? 0 : at(k, i).distance; }
  bool is_distance(std::size_t k, std::size_t i, clearance::real d) const {
    const pair& a = at(k, i);
    if (unknown(k, i)) return d >= 0 && wide(d) <= a.surface + a.error;
    return std::abs(wide(d) - a.distance) <= a.error;
  }

  auto ask(auto question) const {
    return clearance::ask(clearance::host{.threads = 1}, s_.model, s_.poses,
                          clearance::placed<clearance::point_span>{clearance::point_span(points_), cloud_}, question);
  }

  void each_point() {
    const auto all = ask(clearance::distances{.which = true});
    const auto parts = ask(clearance::distances_per_part{});
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const std::size_t part = all.part[i];
      t_.require(
          part < parts_ && is_distance(part, i, all.distance[i]) && wide(all.distance[i]) <= highest(i) + error_[i],
          "distance", "point %zu: %.9g, not %.9Lg", i, double(all.distance[i]), least_[i]);
      if (part < parts_)
        t_.require(is_primitive(part, i, all.primitive[i]), "witness", "point %zu of part %zu", i, part);
      wide low = std::numeric_limits<wide>::infinity();
      for (std::size_t k = 0; k < parts_; ++k) low = std::min(low, at(k, i).low);
      t_.require(wide(all.certain.lower(all.distance[i])) <= low, "bracket", "point %zu: from %.9g, and it is %.9Lg", i,
                 double(all.certain.lower(all.distance[i])), low);
      for (std::size_t k = 0; k < parts_; ++k)
        t_.require(is_distance(k, i, parts.of(k)[i]), "every part", "point %zu, part %zu: %.9g, not %.9Lg", i, k,
                   double(parts.of(k)[i]), at(k, i).distance);
      for (std::size_t k = 0; k < parts_; ++k)  // the spheres are in the solid, and the gap holds
        if (signs && at(k, i).where != side::unknown)
          t_.require(
              at(k, i).high <= std::max(at(k, i).distance, wide(0)) + wide(facts(k).tolerance) + at(k, i).error &&
                  at(k, i).low >= at(k, i).distance - slop(k) - at(k, i).error,
              "gap", "point %zu, part %zu: %.9Lg, but %.9Lg", i, k, at(k, i).distance, at(k, i).low);
    }
  }
  wide highest(std::size_t i) const {
    wide least = std::numeric_limits<wide>::infinity();
    for (std::size_t k = 0; k < parts_; ++k)
      least = std::min(least, unknown(k, i) ? at(k, i).surface : at(k, i).distance);
    return least;
  }
  bool is_primitive(std::size_t k, std::size_t i, std::uint32_t id) const {
    const pair& a = at(k, i);
    const place q = moved_back(s_.poses[k], moved(cloud_, wider<wide>(points_[i])));
    if constexpr (signs) {
      if (id >= s_.bodies[k].spheres.size()) return false;
      const auto& ball = s_.bodies[k].spheres[id];
      return length(q - wider<wide>(ball.center)) - wide(ball.radius) <= a.distance + 2 * a.error;
    } else {
      if (id == clearance::none) return a.where != side::outside || a.surface <= a.error;
      if (id >= s_.bodies[k].its->faces().size()) return a.where == side::unknown;  // of a cap
      return s_.bodies[k].its->to_face(q, id) <= a.surface + 2 * a.error;
    }
  }

  void least() {
    const auto r = ask(clearance::min_distance{});
    const auto parts = ask(clearance::min_distance_per_part{});
    for (const auto& one : {r, parts.all}) {
      t_.require(one.part < parts_ && one.point < points_.size(), "minimum", "of part %u, point %u", one.part,
                 one.point);
      if (!(one.part < parts_ && one.point < points_.size())) continue;
      t_.require(is_distance(one.part, one.point, one.distance) && wide(one.distance) <= nearest_high() + most_error_,
                 "minimum", "%.9g, not %.9Lg", double(one.distance), nearest_);
      t_.require(wide(one.lower) <= solid_low_ && solid_high_ <= wide(one.upper), "bracket",
                 "%.9g to %.9g, not %.9Lg to %.9Lg", double(one.lower), double(one.upper), solid_low_, solid_high_);
      using clearance::state;
      const bool right = one.state == state::free        ? solid_low_ > 0
                         : one.state == state::collision ? solid_high_ == 0
                                                         : one.state == state::possible && one.lower == 0;
      t_.require(right, "state", "%s at %.9Lg", to_string(one.state), solid_low_);
      witness(one);
    }
    for (std::size_t k = 0; k < parts_; ++k) {
      const auto& m = parts.parts[k];
      wide its = std::numeric_limits<wide>::infinity(), error = 0;
      for (std::size_t i = 0; i < points_.size(); ++i)
        its = std::min(its, unknown(k, i) ? at(k, i).surface : at(k, i).distance),
        error = std::max(error, at(k, i).error);
      t_.require(m.point < points_.size() && is_distance(k, m.point, m.distance) && wide(m.distance) <= its + error,
                 "part's minimum", "part %zu: %.9g, not %.9Lg", k, double(m.distance), its);
    }
  }
  /// Many configurations, which are searched by a tree over the points; all are the same one.
  void many() {
    constexpr std::size_t configurations = 12;
    std::vector<Eigen::Isometry3d> poses;
    for (std::size_t c = 0; c < configurations; ++c) poses.insert(poses.end(), s_.poses.begin(), s_.poses.end());
    const clearance::placed<clearance::point_span> cloud{clearance::point_span(points_), cloud_};
    const auto all = clearance::ask(clearance::host{.threads = 1}, s_.model, poses, cloud, clearance::min_distances{});
    for (const auto& one : all.of) {
      const bool there = one.part < parts_ && one.point < points_.size();
      t_.require(there && is_distance(one.part, one.point, one.distance) &&
                     wide(one.distance) <= nearest_high() + most_error_ && wide(one.lower) <= solid_low_ &&
                     solid_high_ <= wide(one.upper),
                 "many configurations", "%.9g in %.9g to %.9g, not %.9Lg", double(one.distance), double(one.lower),
                 double(one.upper), nearest_);
    }
  }
  wide nearest_high() const {
    wide least = std::numeric_limits<wide>::infinity();
    for (std::size_t i = 0; i < points_.size(); ++i) least = std::min(least, highest(i));
    return least;
  }
  template <class Result>
  void witness(const Result& r) {
    const pair& a = at(r.part, r.point);
    const place true_at = moved(cloud_, wider<wide>(points_[r.point])), nearest = wider<wide>(r.nearest);
    const wide world = length(true_at) * 0x1p-45L, error = 2 * a.error + world;
    t_.require(length(wider<wide>(r.at) - true_at) <= error, "witness", "point %u is elsewhere", r.point);
    const place on = moved_back(s_.poses[r.part], nearest);
    const wide away = length(true_at - nearest), depth = signs ? std::abs(a.distance) : a.surface;
    wide off = 0;
    if constexpr (signs) {
      const auto& ball = s_.bodies[r.part].spheres[r.primitive];
      off = std::abs(length(on - wider<wide>(ball.center)) - wide(ball.radius));
    } else if (r.primitive < s_.bodies[r.part].its->faces().size() || s_.bodies[r.part].its->clean()) {
      off = s_.bodies[r.part].its->surface(on);
    } else {
      return;  // a cap's
    }
    t_.require(off <= error, "witness", "its nearest place is %.3Lg off part %u", off, r.part);
    t_.require(std::abs(away - depth) <= error, "witness", "it is %.9Lg away, not %.9Lg", away, depth);
    const place normal = wider<wide>(r.normal);
    const bool inside = signs ? a.distance < 0 : a.where == side::inside;
    if (away < 1e4L * error || a.where == side::unknown) return;
    const wide along = dot(normal, true_at - nearest) / away * (inside ? -1 : 1);
    t_.require(along > 0.999L && std::abs(length(normal) - 1) < 1e-5L, "normal", "%.6Lg along the way", along);
  }

  void lists() {
    const wide span = median();
    for (const double radius : {double(span) / 4, double(span), -double(span) / 8}) {
      const auto near = ask(clearance::within{{radius}});
      std::vector<char> listed(parts_ * points_.size(), 0);
      for (const auto& p : near.pairs) {
        ++listed[p.part * points_.size() + p.point];
        t_.require(is_distance(p.part, p.point, p.distance), "within", "part %u, point %u: %.9g", p.part, p.point,
                   double(p.distance));
      }
      for (std::size_t k = 0; k < parts_; ++k)
        for (std::size_t i = 0; i < points_.size(); ++i) {
          const pair& a = at(k, i);
          if (unknown(k, i)) continue;
          const bool must = a.distance <= wide(radius) - a.error, may = a.distance <= wide(radius) + a.error;
          const int count = listed[k * points_.size() + i];
          t_.require(count == 1 ? may : count == 0 && !must, "within", "part %zu, point %zu at %.9Lg: listed %d times",
                     k, i, a.distance, count);
        }
    }
    for (const std::size_t count : {std::size_t(1), std::size_t(9)}) {
      const auto near = ask(clearance::nearest_k{count});
      for (std::size_t k = 0; k < parts_; ++k) {
        std::vector<wide> all;
        wide error = 0;
        for (std::size_t i = 0; i < points_.size(); ++i)
          all.push_back(unknown(k, i) ? at(k, i).surface : at(k, i).distance), error = std::max(error, at(k, i).error);
        std::sort(all.begin(), all.end());
        for (std::size_t j = 0; j < std::min(count, all.size()); ++j) {
          const auto& p = near.of(k)[j];
          const bool there = p.point < points_.size() && is_distance(k, p.point, p.distance);
          const bool unsure = !signs && !s_.bodies[k].its->clean();
          t_.require(
              there && (unsure ? wide(p.distance) <= all[j] + error : std::abs(wide(p.distance) - all[j]) <= error),
              "nearest", "part %zu, number %zu: %.9g, not %.9Lg", k, j, double(p.distance), all[j]);
        }
      }
    }
    const std::vector<double> limits{0, double(span) / 4, double(span)};
    const auto zones = ask(clearance::zones{limits});
    for (std::size_t k = 0; k < parts_; ++k)
      for (std::size_t z = 0; z < limits.size(); ++z) {
        std::uint64_t least = 0, most = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
          const pair& a = at(k, i);
          const wide off = 2 * most_error_ + slop(k);
          least += a.low <= wide(limits[z]), most += lowest(k, i) <= wide(limits[z]) + off;
        }
        const auto found = zones.of(k, z).points;
        t_.require(least <= found && found <= most, "zones", "part %zu, zone %zu: %llu points, not %llu to %llu", k, z,
                   (unsigned long long)found, (unsigned long long)least, (unsigned long long)most);
        t_.add("zones", points_.size() - 1);
      }
    for (const double margin : limits) {
      const auto c = ask(clearance::in_collision{{margin}});
      wide low = std::numeric_limits<wide>::infinity(), high = low;
      for (const pair& a : pairs_) low = std::min(low, a.low), high = std::min(high, a.high);
      const bool right = c.state == clearance::state::free        ? low > wide(margin)
                         : c.state == clearance::state::collision ? high <= wide(margin)
                                                                  : c.state == clearance::state::possible;
      t_.require(right, "collision", "%s within %.9g at %.9Lg", to_string(c.state), margin, low);
    }
  }
  /// A length by which some points are nearer and others farther.
  wide median() const {
    std::vector<wide> all(least_);
    std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(all.size() / 2), all.end());
    return std::max(std::abs(all[all.size() / 2]), wide(1e-3));
  }

  void labels() {
    const double padding = double(median()) / 3;
    const auto filtered = clearance::min_distance_filtered(
        clearance::host{.threads = 1}, s_.model, s_.poses,
        clearance::placed<clearance::point_span>{clearance::point_span(points_), cloud_},
        clearance::self_filter{{padding}});
    wide rest = std::numeric_limits<wide>::infinity(), rest_high = rest;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      wide low = std::numeric_limits<wide>::infinity(), high = low;
      for (std::size_t k = 0; k < parts_; ++k) low = std::min(low, at(k, i).low), high = std::min(high, at(k, i).high);
      using clearance::point_label;
      const auto label = filtered.filter.labels[i];
      const bool right = label == point_label::own    ? high <= wide(padding)
                         : label == point_label::rest ? low > wide(padding)
                                                      : label == point_label::uncertain;
      t_.require(right, "filter", "point %zu at %.9Lg within %.9g: %d", i, low, padding, int(label));
      if (label != point_label::own) rest = std::min(rest, low), rest_high = std::min(rest_high, high);
    }
    if (rest < std::numeric_limits<wide>::infinity())
      t_.require(wide(filtered.rest.lower) <= rest && rest_high <= wide(filtered.rest.upper), "filter",
                 "the rest from %.9g to %.9g, not %.9Lg", double(filtered.rest.lower), double(filtered.rest.upper),
                 rest);
  }

  const scene<Model>& s_;
  std::span<const clearance::vec3> points_;
  Eigen::Isometry3d cloud_;
  tally& t_;
  std::size_t parts_;
  std::vector<pair> pairs_;
  std::vector<wide> least_, error_;
  wide nearest_ = std::numeric_limits<wide>::infinity(), solid_low_ = nearest_, solid_high_ = nearest_, most_error_ = 0;
};

/// The ways that pixels hide: the least distance of all is that of the way from each pixel's place up to `farthest`.
template <class Model>
void judge_ways(const scene<Model>& s, std::span<const float> depths, std::uint32_t width,
                const Eigen::Isometry3d& camera, clearance::real farthest, tally& t) {
  const auto height = std::uint32_t(depths.size() / width);
  const double f = width, cx = width / 2.0 - 0.5, cy = height / 2.0 - 0.5;
  const clearance::depth_image<float> image(depths.data(), width, height, {f, f, cx, cy});
  const clearance::hidden<clearance::depth_image<float>> room{image, {0.1f, farthest}, 0};
  const auto r = clearance::ask(clearance::host{.threads = 1}, s.model, s.poses,
                                clearance::placed<clearance::hidden<clearance::depth_image<float>>>{room, camera},
                                clearance::min_distance{});
  wide least = std::numeric_limits<wide>::infinity(), low = least, scale = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const wide u = wide(i % width) - wide(cx), v = wide(i / width) - wide(cy), z = depths[i];
    const place way{u / wide(f), v / wide(f), 1}, from = moved(camera, z * way),
                                                  to = moved(camera, wide(farthest) * way);
    for (std::size_t k = 0; k < s.bodies.size(); ++k) {
      const place p = moved_back(s.poses[k], from), q = moved_back(s.poses[k], to);
      scale = std::max({scale, length(p) + wide(s.model.parts()[k].facts.radius), length(q) + length(q - p)});
      if constexpr (judge<Model>::signs) {
        for (const auto& ball : s.bodies[k].spheres) {
          const place c = wider<wide>(ball.center);
          low = least = std::min(least, length(nearest_of_segment(p - c, q - c)) - wide(ball.radius));
        }
      } else {
        const solid& its = *s.bodies[k].its;
        const side where = its.where(p);
        if (where != side::outside) low = 0;
        if (where == side::inside) least = 0;
        least = its.surface(p, q, least), low = std::min(low, least);
      }
    }
  }
  const wide error = 0x1p-19L * scale;
  t.require(low - error <= wide(r.distance) && wide(r.distance) <= least + error, "ways", "%.9g, not %.9Lg to %.9Lg",
            double(r.distance), low, least);
  t.add("ways", depths.size() - 1);
}

}  // namespace reference
