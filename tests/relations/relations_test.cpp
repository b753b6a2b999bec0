// SPDX-License-Identifier: BSD-3-Clause
// What must hold between the answers to two related scenes, whatever is asked: no reference is needed, and no question
// is named. The first answer is of one call, the other of a prepared question that knows the first scene.
#include "forms/forms.hpp"
#include "relations/facts.hpp"
#include "support/catch.hpp"

#include <functional>
#include <numeric>

namespace relations_test {

using namespace testing;
using clearance::host, clearance::state;

namespace {

/// Clouds whose points have names.
struct setting {
  struct cloud {
    std::vector<vec3> points;
    Eigen::Isometry3d pose;
    std::vector<std::uint64_t> names;
  };
  std::vector<Eigen::Isometry3d> poses;
  std::vector<cloud> seen;
  Eigen::Vector3d inside = {0, 0, 0};  ///< As deep in the robot as can be.

  explicit setting(const moving_frames& f) : poses(f.s.poses) {
    const auto here = f.here();
    for (std::size_t c = 0; c < here.size(); ++c) add(f.points[c], here[c].pose, (c + 1) * 1000000);
  }
  void add(const std::vector<vec3>& points, const Eigen::Isometry3d& pose, std::uint64_t first) {
    seen.push_back({points, pose, {}});
    seen.back().names.resize(points.size());
    std::iota(seen.back().names.begin(), seen.back().names.end(), first);
  }
  clouds here() const {
    clouds all;
    for (const cloud& c : seen) all.push_back({clearance::point_span(c.points), c.pose});
    return all;
  }
  point_ids names() const {
    point_ids all;
    for (const cloud& c : seen) all.push_back(c.names);
    return all;
  }
};

constexpr std::uint64_t added = std::uint64_t(1) << 40;  ///< The name of the first point that is new.

using change = std::function<void(setting&, dice&)>;
using two_facts = std::function<bool(const fact& before, const fact& after)>;
enum class found { all, none_lost, lone_lost, some_lost };  ///< Which facts of the first answer are in the second.

bool same(const fact& a, const fact& b) { return a.kind == b.kind && a.bits == b.bits; }
bool rank_falls(const fact& a, const fact& b) {  // from a to b
  const auto rank = [](const fact& f) {
    const auto s = state(f.bits);
    return s == state::free ? 0 : s == state::possible ? 1 : s == state::collision ? 2 : -1;
  };
  return rank(a) != rank(b) && (rank(a) < 0 || rank(b) < rank(a));
}
/// In world coordinates numbers have another rounding, which brackets cover; distances do not.
bool moved(const fact& a, const fact& b) {
  const bool rounded = a.real && (a.kind == fact_kind::other || a.kind == fact_kind::near);
  return a.kind == fact_kind::place || same(a, b) || (rounded && std::abs(a.value - b.value) < 1e-5);
}
/// Something may have come nearer, and nothing has gone.
bool nearer(const fact& a, const fact& b) {
  switch (a.kind) {
    case fact_kind::near:
      return !(a.value < b.value) || same(a, b);
    case fact_kind::pair:
      return same(a, b) || b.value < a.value;
    case fact_kind::count:
      return a.value <= b.value;
    case fact_kind::state:
      return !rank_falls(a, b);
    default:
      return true;
  }
}
bool nearer_elsewhere(const fact& a, const fact& b) { return a.kind == fact_kind::pair ? same(a, b) : nearer(a, b); }
/// A question of longer lengths: what was near enough is as near.
bool wider(const fact& a, const fact& b) {
  return a.kind == fact_kind::pair && std::isfinite(a.value) ? same(a, b) : nearer(a, b);
}
/// Something of the robot may have gone, and other numbers have another rounding.
bool farther(const fact& a, const fact& b) {
  if (a.kind == fact_kind::near || a.kind == fact_kind::pair) return same(a, b) || !(b.value < a.value - 1e-5);
  return nearer(b, a);
}

void compare(verdict& v, const std::string& what, const facts& before, const facts& after, found wanted,
             const two_facts& holds) {
  std::size_t met = 0;
  v.require(!before.contradicts && !after.contradicts, what, ": two copies of a point differ");
  for (const fact& f : before.all()) {
    const fact* const its = after.find(f);
    if (its == nullptr) {
      v.require(wanted == found::some_lost || (wanted == found::lone_lost && f.kind == fact_kind::lone), what,
                ": a fact of kind ", int(f.kind), " is lost, value ", f.value);
    } else {
      v.require(holds(f, *its), what, ": kind ", int(f.kind), ", ", f.value, " became ", its->value);
      ++met;
    }
  }
  v.require(met > 0, what, ": nothing is compared");
  if (wanted == found::all)
    v.require(before.all().size() == after.all().size(), what, ": ", before.all().size(), " facts became ",
              after.all().size());
}

struct relation {
  const char* name;
  change apply;
  found wanted;
  two_facts holds;
};

const std::vector<relation> relations = {
    {"moved by a rigid pose",
     [](setting& s, dice& d) {
       const Eigen::Isometry3d moved = d.pose(3);
       for (auto& pose : s.poses) pose = moved * pose;
       for (auto& c : s.seen) c.pose = moved * c.pose;
     },
     found::all, moved},
    {"points in another order",
     [](setting& s, dice& d) {
       for (auto& c : s.seen)
         for (std::size_t k = c.points.size(); k > 1; --k) {
           const std::size_t other = d.below(unsigned(k));
           std::swap(c.points[k - 1], c.points[other]), std::swap(c.names[k - 1], c.names[other]);
         }
     },
     found::all, [](const fact& a, const fact& b) { return a.kind == fact_kind::lowest || same(a, b); }},
    {"each cloud in two",
     [](setting& s, dice& d) {
       std::vector<setting::cloud> all;
       for (const auto& c : s.seen) {
         const auto at = std::ptrdiff_t(d.below(unsigned(c.points.size() + 1)));
         all.push_back({{c.points.begin(), c.points.begin() + at}, c.pose, {c.names.begin(), c.names.begin() + at}});
         all.push_back({{c.points.begin() + at, c.points.end()}, c.pose, {c.names.begin() + at, c.names.end()}});
       }
       s.seen = all;
     },
     found::all, same},
    {"far points more",
     [](setting& s, dice& d) {
       auto far = d.points(150, 20, {60, 60, 60});
       s.add(far, shifted(0.1, 0, 0), added);
     },
     found::none_lost,
     [](const fact& a, const fact& b) {
       return same(a, b) || (a.kind == fact_kind::count && a.value + 150 == b.value);
     }},
    {"a point in the robot more",
     [](setting& s, dice&) {
       const Eigen::Vector3d& p = s.inside;
       s.add({vec3{real(p.x()), real(p.y()), real(p.z())}}, shifted(0, 0, 0), added);
     },
     found::some_lost, nearer_elsewhere},
};

/// The middle of the largest sphere, or a place in the first mesh.
template <class Model>
Eigen::Vector3d inside_of(const Model&, const moving_frames& f) {
  if constexpr (clearance::scan::has_interior<typename Model::view_type>)
    return f.s.poses[0] * Eigen::Vector3d(0.1, 0.1, 0.1);
  Eigen::Vector3d at(0, 0, 0);
  real most = 0;
  for (std::size_t k = 0; k < f.s.parts.size(); ++k)
    for (const inner_sphere& each : f.s.parts[k])
      if (each.radius > most) {
        most = each.radius;
        at = f.s.poses[k] * Eigen::Vector3d(each.center.x, each.center.y, each.center.z);
      }
  return at;
}

/// Calls `f(name, question, model, model without its last part, frame)`. In larger frames some points are inside of
/// meshes, all 0 away: which is named depends on their order.
template <class F>
void ask_some(const F& f) {
  moving_frames frames(4, 77);
  const auto spheres = frames.model();
  auto some = frames.s;
  some.parts.pop_back();
  const auto fewer = make_model<clearance::sphere>(some, {}, clearance::wrapped{});
  const auto meshes = closed_boxes(4), fewer_meshes = closed_boxes(3);
  for (; frames.there(); frames.next()) {
    if (frames.points[0].size() < 100 || frames.points[0].size() > 20000) continue;
    for_each_question([&](const char* name, const auto& q) { f(name, q, spheres, fewer, frames); });
    if (frames.points[0].size() > 3000) continue;
    for_each_question_of_meshes([&](const char* name, const auto& q) { f(name, q, meshes, fewer_meshes, frames); });
    f("min_distance of meshes", clearance::min_distance{}, meshes, fewer_meshes, frames);
  }
}

template <class Q, class Model>
facts ask_facts(const Model& model, const setting& s, const Q& q, const point_ids& names) {
  return {ask(host{2}, model, s.poses, s.here(), q), names};
}
template <class Query>
facts known_facts(Query& prepared, const setting& s, const auto& q, const point_ids& names) {
  using result = typename std::remove_cvref_t<decltype(q)>::result;
  return {result(prepared(s.poses, s.here(), q)), names};
}

/// Calls `f` with each option, by its type. A question may have none.
template <class Q, class F>
void with_options(Q& q, const F& f) {
  if constexpr (clearance::detail::count_members<Q>() != 0)
    std::apply([&](auto&... each) { (f(each), ...); }, clearance::detail::members_of(q));
}
/// All lengths are longer but `radii`, which make answers less certain. Returns whether there is one.
template <class Q>
bool lengthen(Q& q) {
  bool any = false;
  with_options(q, [&]<class T>(T& option) {
    if constexpr (std::is_same_v<T, double>)
      option += 0.04, any = true;
    else if constexpr (std::is_same_v<T, std::vector<double>>) {
      if constexpr (requires { q.radii; })
        if (&option == &q.radii) return;
      for (double& each : option) each += 0.04, any = true;
    }
  });
  return any;
}
/// All numbers of points are twice as large.
template <class Q>
void double_numbers(Q& q) {
  with_options(q, []<class T>(T& option) {
    if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) option *= 2;
  });
}

}  // namespace

TEST_CASE("Related scenes have related answers") {
  verdict v;
  dice d(5);
  std::size_t asked = 0;
  ask_some([&](const char* name, const auto& q, const auto& model, const auto&, const moving_frames& f) {
    const setting before(f);
    const auto names = before.names();
    const facts expected = ask_facts(model, before, q, names);
    clearance::query prepared(host{2}, model, q);
    known_facts(prepared, before, q, names);
    for (const relation& r : relations) {
      setting after(f);
      after.inside = inside_of(model, f);
      r.apply(after, d);
      const auto its = after.names();
      const facts now = known_facts(prepared, after, q, its);
      compare(v, std::string(name) + ", " + r.name, expected, now, r.wanted, r.holds);
      if (r.wanted == found::some_lost) v.require(now.notice(added), name, ": a point inside is not noticed");
      ++asked;
    }
  });
  CHECK(asked > 0);
}

TEST_CASE("Doubled points are found twice") {
  verdict v;
  ask_some([&](const char* name, auto q, const auto& model, const auto&, const moving_frames& f) {
    const setting before(f);
    setting after(f);
    for (const auto& c : before.seen) after.seen.push_back(c);
    const auto names = before.names(), its = after.names();
    const facts expected = ask_facts(model, before, q, names);
    double_numbers(q);
    compare(v, std::string(name) + ", twice", expected, ask_facts(model, after, q, its), found::all,
            [](const fact& a, const fact& b) { return a.whole ? a.value * 2 == b.value : same(a, b); });
  });
}

TEST_CASE("A longer length loses nothing") {
  verdict v;
  std::size_t asked = 0;
  ask_some([&](const char* name, auto q, const auto& model, const auto&, const moving_frames& f) {
    const setting scene(f);
    const auto names = scene.names();
    clearance::query prepared(host{2}, model, q);
    const facts expected = known_facts(prepared, scene, q, names);
    if (!lengthen(q)) return;
    compare(v, std::string(name) + ", wider", expected, known_facts(prepared, scene, q, names), found::lone_lost,
            wider);
    ++asked;
  });
  CHECK(asked > 0);
}

TEST_CASE("Without a link nothing is nearer") {
  verdict v;
  ask_some([&](const char* name, const auto& q, const auto& model, const auto& fewer, const moving_frames& f) {
    const setting before(f);
    setting after(f);
    after.poses.pop_back();
    const auto names = before.names();
    compare(v, std::string(name) + ", without a link", ask_facts(model, before, q, names),
            ask_facts(fewer, after, q, names), found::some_lost, farther);
  });
}

TEST_CASE("Questions agree about the same pairs") {
  verdict v;
  const auto agree = [&](const char* robot, const auto& model, const moving_frames& f) {
    const auto asked = [&](const auto& q) { return ask(host{2}, model, f.s.poses, f.here(), q); };
    const std::string what = std::string(robot) + ", frame " + std::to_string(f.number);
    const std::size_t parts = f.s.poses.size();
    const auto all = asked(clearance::min_distance{});
    const auto per_part = asked(clearance::min_distance_per_part{});
    const auto rows = asked(clearance::distances_per_part{});
    const auto points = asked(clearance::distances{});
    const auto first = asked(clearance::nearest_k{.k = 1});
    const auto near = asked(clearance::within{{0.3}});
    const auto zones = asked(clearance::zones{.thresholds = {0.1, 0.3}});
    const auto one = asked(clearance::min_distances{});
    const auto each = asked(clearance::min_distances_per_part{});
    v.require(same_answer(one.of.at(0), all), what, ": one configuration");
    real least = clearance::infinity;
    for (std::size_t k = 0; k < parts; ++k) {
      const auto& m = per_part.parts.at(k);
      const auto& pair = first.of(k)[0];
      v.require(pair.distance == m.distance && pair.cloud == m.cloud && pair.point == m.point, what,
                ": the nearest one and the minimum of part ", k);
      v.require(all.valid == 0 || (each.of(0)[k].distance == m.distance && each.of(0)[k].point == m.point), what,
                ": a part of a configuration");
      std::size_t listed = 0, counted[2] = {0, 0};
      real lowest = clearance::infinity;
      for (const real d : rows.of(k)) {
        if (d <= 0.3f) ++listed;
        for (const int z : {0, 1}) counted[z] += d <= real(z == 0 ? 0.1 : 0.3);
        if (d < lowest) lowest = d;
      }
      least = std::min(least, lowest);
      v.require(lowest == m.distance, what, ": the least of its distances, part ", k);
      v.require(near.offsets[k + 1] - near.offsets[k] == listed, what, ": within, part ", k);
      for (const std::size_t z : {0, 1}) {
        v.require(zones.of(k, z).points == counted[z], what, ": zone ", z, " of part ", k);
        v.require(counted[z] == 0 || zones.of(k, z).nearest == lowest, what, ": the nearest of zone ", z);
      }
    }
    v.require(least == all.distance || std::isnan(all.distance), what, ": the least of all");
    for (std::size_t i = 0; i < points.distance.size(); ++i) {
      real its = points.distance[i];
      for (std::size_t k = 0; k < parts; ++k) its = std::min(its, rows.of(k)[i]);
      v.require(same_bits(its, points.distance[i]), what, ": point ", i, " is not as far as its nearest part");
      if (!std::isnan(its)) {
        bool one_has_it = false;
        for (std::size_t k = 0; k < parts; ++k) one_has_it |= rows.of(k)[i] == its;
        v.require(one_has_it, what, ": no part is as near to point ", i);
      }
    }
    for (const double margin : {0.02, double(all.upper) + 1e-4, double(all.lower) - 1e-4}) {
      const auto said = asked(clearance::in_collision{{margin}}).state;
      v.require(same_answer(asked(clearance::in_collisions{{margin}}).of, std::vector{said}), what, ": margin ",
                margin);
      if (all.valid == 0) continue;
      v.require(margin < all.upper || said == state::collision, what, ": within ", margin, " for certain");
      v.require(margin >= all.lower || margin < 0 || said == state::free, what, ": certainly beyond ", margin);
    }
  };
  const auto meshes = closed_boxes(4);
  for (moving_frames f(4, 81); f.there(); f.next()) agree("spheres", f.model(), f), agree("meshes", meshes, f);
}

}  // namespace relations_test
