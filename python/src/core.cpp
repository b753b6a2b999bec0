// SPDX-License-Identifier: BSD-3-Clause
#include "clouds.hpp"
#include "gradients.hpp"
#include "query.hpp"
#include "questions.hpp"
#include "robot.hpp"
#include "sensor_messages.hpp"

template <class E>
void bind_enum(nb::module_& m) {
  nb::enum_<E> bound(m, declared<E>::name, declared<E>::doc);
  std::apply([&](const auto&... v) { (bound.value(v.name, v.value), ...); }, declared<E>::values);
}

NB_MODULE(_core, m) {
  m.attr("none") = clearance::none;
  m.attr("__version__") = CLEARANCE_VERSION_TEXT;
  nb::class_<clearance::distance_certainty>(m, "DistanceCertainty",
                                            "How certain each distance of an answer is: lower() of it is proven.")
      .def("lower", &clearance::distance_certainty::lower, nb::arg("distance"),
           "The solid is at least this far away, metres; 0 if nothing more is certain.")
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
  bind_gradients(m);
}
