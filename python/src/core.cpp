// SPDX-License-Identifier: BSD-3-Clause
#include "clouds.hpp"
#include "gradients.hpp"
#include "query.hpp"
#include "questions.hpp"
#include "robot.hpp"
#include "self_distance.hpp"
#include "sensor_messages.hpp"
#include "separation.hpp"

#include <clearance/ground/numbered.hpp>

#include <nanobind/stl/vector.h>

#include <algorithm>

template <class E>
void bind_enum(nb::module_& m) {
  nb::enum_<E> bound(m, declared<E>::name, declared<E>::doc, nb::is_arithmetic());  // arrays have their numbers
  std::apply([&](const auto&... v) { (bound.value(v.name, v.value), ...); }, declared<E>::values);
}

NB_MODULE(_core, m) {
  // At the interpreter's end a daemon thread still holds what it uses, which is no leak and nothing that a user could
  // mend. test_nothing_leaks counts memory while a program runs.
  nb::set_leak_warnings(false);
  m.attr("none") = clearance::none;
  m.attr("__version__") = CLEARANCE_VERSION_TEXT;
  nb::class_<clearance::distance_certainty>(m, "DistanceCertainty",
                                            "How certain each distance of an answer is: lower() of it is proven.")
      .def(
          "lower",
          [](const clearance::distance_certainty& c, given_for<double> distance, nb::handle part) {
            const auto metres = clearance::real(argument_of(distance, "distance"));
            if (part.is_none()) return c.lower(metres);
            const std::size_t which = index_of(part, "part");
            if (!c.slops.empty()) clearance::check_number("part", which, c.slops.size());
            return c.lower(metres, which);
          },
          nb::arg("distance").none(), nb::arg("part").none() = nb::none(),
          "The solid is at least this far away, metres; 0 if nothing more is certain. part: whose distance it is; "
          "where "
          "the answer keeps each part's gap and tolerance, only that part's are taken off, and IndexError is raised "
          "for "
          "a part that is not there.")
      .def(
          "to_dict",
          [](const clearance::distance_certainty& c) {
            nb::dict all;
            all["error"] = c.error.here;
            all["error_per_metre"] = c.error.per_metre;
            all["slop"] = c.slop;
            all["slops"] = nb::cast(std::vector<double>(c.slops.begin(), c.slops.end()));
            return all;
          },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"),
          "What it is made of: errors of computing, and by how much parts may be nearer than their primitives, metres.")
      .def("__getstate__",
           [](const clearance::distance_certainty& c) {
             return nb::make_tuple(c.error.here, c.error.per_metre, c.slop,
                                   nb::cast(std::vector<double>(c.slops.begin(), c.slops.end())));
           })
      .def("__setstate__",
           [](clearance::distance_certainty& self, const nb::tuple& state) {
             new (&self) clearance::distance_certainty{
                 .error = {nb::cast<double>(state[0]), nb::cast<double>(state[1])}, .slop = nb::cast<double>(state[2])};
             const auto slops = nb::cast<std::vector<double>>(state[3]);
             if (slops.empty()) return;
             self.slops.resize(slops.size());
             std::ranges::copy(slops, self.slops.data());
           })
      .def("__repr__", [](const clearance::distance_certainty& c) {
        return "DistanceCertainty(1 m is certainly at least " + std::to_string(c.lower(1)) + " m)";
      });
  bind_robot(m);
  bind_clouds(m);
  bind_sensor_messages(m);
  for_each_declared([&]<class T>() {
    if constexpr (declared_enum<T>)
      bind_enum<T>(m);
    else if constexpr (declared<T>::question || declared<T>::option)
      bind_question<T>(m);
    else
      bind_result<T>(m);
  });
  bind_query(m);
  bind_separation(m);
  bind_self_distance(m);
  bind_gradients(m);
}
