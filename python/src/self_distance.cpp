// SPDX-License-Identifier: BSD-3-Clause
// How far a robot is from itself: the pairs of parts that can meet, and what is asked about them.
#include "self_distance.hpp"

#include "arrays.hpp"
#include "robot.hpp"
#include "values.hpp"

#include <clearance/backends/host.hpp>
#include <clearance/io/sentence.hpp>
#include <clearance/io/srdf.hpp>
#include <clearance/self_distances.hpp>

#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <mutex>

using namespace clearance;

namespace {

using named_pairs = std::vector<std::pair<std::string, std::string>>;

/// What Python's PartPairs holds. It never changes.
struct pairs_object {
  part_pairs pairs;
  part_names names;
  std::vector<std::string> notes;
  named_pairs always, never;  ///< What samples said.

  named_pairs all() const {
    named_pairs made;
    for (std::size_t a = 0; a < pairs.parts(); ++a)
      for (const std::uint32_t b : pairs.above(a)) made.emplace_back((*names)[a], (*names)[b]);
    return made;
  }
  std::pair<std::size_t, std::size_t> of(nb::handle a, nb::handle b) const {
    return {part_of(a, "a", names), part_of(b, "b", names)};
  }
  pairs_object with(nb::handle a, nb::handle b, bool has) const {
    pairs_object made = *this;
    const auto [k, l] = of(a, b);
    made.pairs.set(k, l, has);
    return made;
  }
};

pairs_object pairs_of(const robot_model& robot, nb::handle srdf) {
  pairs_object made{part_pairs(robot.parts()), robot.names, {}, {}, {}};
  if (srdf.is_none() && !robot.description) return made;
  const io::robot& described = robot.described();
  if (srdf.is_none()) {
    made.pairs = io::pairs_without_neighbours(described);
    return made;
  }
  const std::string file = file_of(srdf, "srdf");
  auto read = is_text(file) ? io::load_srdf_text(file, "robot_description_semantic", described)
                            : io::load_srdf(file, described);
  made.pairs = std::move(read.pairs);
  made.notes = std::move(read.notes);
  std::vector<std::size_t> held;
  for (const std::string& name : robot.held) {
    held.push_back(std::size_t(std::ranges::find(*robot.names, name) - robot.names->begin()));
    made.notes.push_back("part " + io::quoted(name) + " is attached: its pairs with what holds it are left out");
  }
  io::remove_pairs_of_held(made.pairs, described, held);
  return made;
}

pairs_object pairs_given(const robot_model& robot, nb::handle given) {
  if (given.is_none()) return pairs_of(robot, given);
  pairs_object* pairs = nullptr;
  if (!nb::try_cast(given, pairs) || !pairs)
    throw nb::type_error(("pairs is what part_pairs(robot) returns, not " + shape_and_type(given)).c_str());
  if (*pairs->names != *robot.names) throw std::invalid_argument("clearance: pairs are of another robot than robot");
  return *pairs;
}

/// What `ask(model)` returns of a robot whose parts are spheres. Throws std::invalid_argument for one of triangles.
template <class Ask>
auto about_spheres(const robot_model& robot, Ask ask) {
  using result = std::invoke_result_t<Ask, const std::variant_alternative_t<0, robot_trees<>>&>;
  return std::visit(
      [&]<class Model>(const Model& model) -> result {
        if constexpr (clearance::detail::views_spheres<
                          typename clearance::detail::part_view_of<Model>::type::hierarchy_type>)
          return ask(model);
        else
          throw std::invalid_argument(
              "clearance: a robot is asked about itself by its inner spheres, and this one has triangles: make it with "
              "model=\"spheres\"");
      },
      *robot.trees);
}

/// A robot's questions about itself.
struct about_itself {
  virtual ~about_itself() = default;
  virtual self_distance_result one(std::span<const Eigen::Isometry3d> poses) = 0;
  virtual std::vector<self_clearance> many(std::span<const Eigen::Isometry3d> poses) = 0;
};
template <class Model>
class about_model final : public about_itself {
 public:
  about_model(const Model& model, const part_pairs& pairs) : one_(host{}, model, pairs), many_(host{}, model, pairs) {}
  self_distance_result one(std::span<const Eigen::Isometry3d> poses) override { return one_(poses); }
  std::vector<self_clearance> many(std::span<const Eigen::Isometry3d> poses) override { return many_(poses); }

 private:
  using view = typename clearance::detail::part_view_of<Model>::type;
  self_query<host, view> one_;
  self_queries<host, view> many_;
};

struct self_query_object {
  std::shared_ptr<robot_model> robot;
  pairs_object pairs;
  std::unique_ptr<about_itself> ask;
  std::mutex one_at_a_time;

  self_query_object(std::shared_ptr<robot_model> robot_, nb::handle pairs_)
      : robot(std::move(robot_)), pairs(pairs_given(*robot, pairs_)) {
    ask = about_spheres(*robot, [&]<class Model>(const Model& model) -> std::unique_ptr<about_itself> {
      return std::make_unique<about_model<Model>>(model, pairs.pairs);
    });
  }

  template <class Ask>
  auto alone(Ask what) {
    const nb::gil_scoped_release others;
    const std::lock_guard lock(one_at_a_time);
    return what();
  }

  nb::object operator()(nb::handle joints, nb::handle poses, nb::handle base, bool ignore_limits, bool rest) {
    const placed_robot at = robot_placed(*robot, joints, poses, base, {ignore_limits, rest});
    const std::size_t parts = robot->parts();
    if (parts != 0 && at.poses.size() > parts && at.poses.size() % parts == 0)
      throw std::invalid_argument("clearance: there are " + std::to_string(at.poses.size() / parts) +
                                  " configurations, and a call asks about one; many(...) asks about many");
    return nb::cast(
        answered<self_distance_result>{alone([&] { return ask->one(at.poses); }), {robot->names, digest_of(at.poses)}});
  }

  nb::object many(nb::handle joints, nb::handle poses, nb::handle base, bool ignore_limits, bool rest) {
    const placed_robot at = robot_placed(*robot, joints, poses, base, {ignore_limits, rest});
    auto* const all = new std::vector<self_clearance>(alone([&] { return ask->many(at.poses); }));
    const nb::capsule owner(all, [](void* p) noexcept { delete static_cast<std::vector<self_clearance>*>(p); });
    const nb::object made = array_of(all->data(), all->size(), owner);
    const bool in_a_row = at.shape.empty() && all->size() != 1;  // poses of all parts, one configuration after another
    return in_a_row ? made : nb::object(made.attr("reshape")(nb::cast(at.shape)));
  }
};

pairs_object sampled(const std::shared_ptr<robot_model>& robot, nb::handle joints, double reach, nb::handle pairs,
                     nb::handle poses, bool ignore_limits) {
  pairs_object made = pairs_given(*robot, pairs);
  const placed_robot at = robot_placed(*robot, joints, poses, nb::none(), {ignore_limits, false});
  sampled_pairs said = [&] {
    const nb::gil_scoped_release others;
    return about_spheres(*robot, [&](const auto& model) {
      return sample_pairs(host{}, model, std::span<const Eigen::Isometry3d>(at.poses), made.pairs, reach);
    });
  }();
  const auto names = [&](const auto& numbers) {
    named_pairs all;
    for (const auto& [a, b] : numbers) all.emplace_back((*robot->names)[a], (*robot->names)[b]);
    return all;
  };
  made.pairs = std::move(said.meeting);
  made.always = names(said.always);
  made.never = names(said.never);
  return made;
}

}  // namespace

void bind_self_distance(nb::module_& m) {
  nb::class_<pairs_object>(
      m, "PartPairs",
      "Which parts of a robot can meet, as part_pairs and sample_pairs say. Iterating gives pairs of names, and "
      "(\"hand\", \"base\") in pairs says whether one is there. It never changes.")
      .def(
          "without", [](const pairs_object& p, nb::handle a, nb::handle b) { return p.with(a, b, false); },
          nb::arg("a").none(), nb::arg("b").none(), "The same without one pair: a and b are parts' names or numbers.")
      .def(
          "including", [](const pairs_object& p, nb::handle a, nb::handle b) { return p.with(a, b, true); },
          nb::arg("a").none(), nb::arg("b").none(), "The same with one pair more.")
      .def_prop_ro(
          "notes", [](const pairs_object& p) { return p.notes; }, "What a person should know about the SRDF file.")
      .def_prop_ro(
          "always", [](const pairs_object& p) { return p.always; },
          "Pairs that sample_pairs removed because they touch in all samples.")
      .def_prop_ro(
          "never", [](const pairs_object& p) { return p.never; },
          "Pairs that sample_pairs removed because they are beyond reach in all samples.")
      .def("__len__", [](const pairs_object& p) { return p.pairs.size(); })
      .def(
          "__iter__", [](const pairs_object& p) { return nb::iter(nb::cast(p.all())); },
          nb::sig("def __iter__(self) -> typing.Iterator[tuple[str, str]]"))
      .def(
          "__contains__",
          [](const pairs_object& p, const std::pair<nb::object, nb::object>& pair) {
            const auto [a, b] = p.of(pair.first, pair.second);
            return a != b && p.pairs.has(a, b);
          },
          nb::arg("pair"), nb::sig("def __contains__(self, pair: tuple[str | int, str | int]) -> bool"))
      .def("__copy__", [](nb::handle self) { return nb::borrow(self); })
      .def(
          "__deepcopy__", [](nb::handle self, nb::handle) { return nb::borrow(self); }, nb::arg("memo"))
      .def("__getstate__",
           [](const pairs_object& p) { return nb::make_tuple(*p.names, p.all(), p.notes, p.always, p.never); })
      .def("__setstate__",
           [](pairs_object& self, const nb::tuple& state) {
             const auto names =
                 std::make_shared<const std::vector<std::string>>(nb::cast<std::vector<std::string>>(state[0]));
             const auto is = nb::cast<named_pairs>(state[1]);
             part_pairs pairs(names->size());
             for (std::size_t a = 0; a < names->size(); ++a)
               for (std::size_t b = a + 1; b < names->size(); ++b)
                 pairs.set(a, b, std::ranges::find(is, std::pair((*names)[a], (*names)[b])) != is.end());
             new (&self) pairs_object{std::move(pairs), names, nb::cast<std::vector<std::string>>(state[2]),
                                      nb::cast<named_pairs>(state[3]), nb::cast<named_pairs>(state[4])};
           })
      .def("__repr__", [](const pairs_object& p) {
        return "<PartPairs: " + std::to_string(p.pairs.size()) + " of " + std::to_string(p.pairs.parts()) + " parts>";
      });
  m.def("part_pairs", &pairs_of, nb::arg("robot"), nb::arg("srdf").none() = nb::none(),
        "Which parts of a robot can meet. Without an SRDF file all pairs but neighbours in its joints: a part and the "
        "nearest one above it, and parts that fixed joints hold together. With one (a file or its text) all but what "
        "it disables, in MoveIt's order; what is noted is in notes. Raises RuntimeError for a damaged file.");
  m.def("sample_pairs", &sampled, nb::arg("robot"), nb::arg("joints").none(), nb::arg("reach"),
        nb::arg("pairs").none() = nb::none(), nb::kw_only(), nb::arg("poses").none() = nb::none(),
        nb::arg("ignore_limits") = false,
        "The pairs without those that touch in all of some configurations, joints (n, joints) spread over the limits, "
        "and those that are farther apart than reach (metres) in all. Samples prove nothing: what they miss, the "
        "answers miss. pairs: from part_pairs; None: part_pairs(robot).");
  nb::class_<self_query_object>(m, "SelfQuery",
                                "Asks how far a robot of inner spheres is from itself, on the CPU: make it once, with "
                                "the pairs of parts that can meet, and ask it of every configuration.")
      .def(nb::init<std::shared_ptr<robot_model>, nb::handle>(), nb::arg("robot"), nb::arg("pairs").none() = nb::none(),
           "pairs: what part_pairs or sample_pairs returned; None: part_pairs(robot). Raises ValueError for a robot of "
           "triangles, and for pairs of another one.")
      .def("__call__", &self_query_object::operator(), nb::arg("joints").none() = nb::none(), nb::kw_only(),
           nb::arg("poses").none() = nb::none(), nb::arg("base").none() = nb::none(), nb::arg("ignore_limits") = false,
           nb::arg("rest") = false,
           "The least distance of all pairs, and each pair's. Where the robot is: as for Query.")
      .def("many", &self_query_object::many, nb::arg("joints").none() = nb::none(), nb::kw_only(),
           nb::arg("poses").none() = nb::none(), nb::arg("base").none() = nb::none(), nb::arg("ignore_limits") = false,
           nb::arg("rest") = false,
           "The least distance in each of many configurations, joints (..., joints) or poses (..., parts, 4, 4): a "
           "structured array (...) with the members of SelfClearance.")
      .def_prop_ro(
          "robot", [](const self_query_object& q) { return q.robot; }, "The robot that is asked about.")
      .def_prop_ro(
          "pairs", [](const self_query_object& q) { return q.pairs; }, "The pairs of its parts that can meet.")
      .def("__reduce__",
           [](nb::handle self) {
             const auto& q = nb::cast<const self_query_object&>(self);
             return nb::make_tuple(self.type(), nb::make_tuple(q.robot, q.pairs));
           })
      .def("__repr__", [](const self_query_object& q) {
        return "<SelfQuery of " + io::quoted(q.robot->name) + ": " + std::to_string(q.pairs.pairs.size()) + " pairs>";
      });
}
