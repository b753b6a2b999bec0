// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <stdexcept>

namespace {

[[noreturn]] void refuse(const char* argument, const char* wanted, nb::handle given) {
  throw std::invalid_argument(std::string("clearance: ") + argument + " is " + wanted + ", not " +
                              nb::cast<std::string>(nb::repr(given)));
}

}  // namespace

std::string shape_and_type(nb::handle given) {
  std::string text = text_of(given.type().attr("__name__"));
  if (nb::hasattr(given, "shape") && nb::hasattr(given, "dtype"))
    text += " of shape " + text_of(nb::tuple(given.attr("shape"))) + " and dtype " + text_of(given.attr("dtype"));
  return text;
}

double number_of(nb::handle given, const char* argument) {
  double value = 0;
  if (nb::isinstance<nb::str>(given) || !nb::try_cast(given, value)) refuse(argument, "a number", given);
  return value;
}

std::size_t count_of(nb::handle given, const char* argument) {
  std::size_t value = 0;
  if (!nb::try_cast(given, value)) refuse(argument, "a whole number, 0 or more", given);
  return value;
}

std::size_t index_of(nb::handle given, const char* argument) {
  const auto wrong = [&](const char* why) {
    return std::string("clearance: ") + argument + " is " + nb::cast<std::string>(nb::repr(given)) + why;
  };
  if (!PyIndex_Check(given.ptr())) throw nb::type_error(wrong(", which is no whole number").c_str());
  const nb::object number = nb::steal(PyNumber_Index(given.ptr()));
  if (!number.is_valid()) nb::raise_python_error();
  std::size_t value = 0;
  if (!nb::try_cast(number, value))
    throw nb::index_error(wrong(number.attr("__lt__")(0).is(nb::bool_(true))
                                    ? ", and numbers begin at 0"
                                    : ", and there is nothing of such a number")
                              .c_str());
  return value;
}

std::array<double, 3> three_of(nb::handle given, const char* argument) {
  std::array<double, 3> value{};
  try {
    const nb::list all(given);
    if (nb::len(all) != 3) refuse(argument, "three numbers", given);
    for (std::size_t k = 0; k < 3; ++k) {
      value[k] = nb::cast<double>(nb::float_(all[k]));
      if (!std::isfinite(value[k])) refuse(argument, "three finite numbers", given);
    }
  } catch (const nb::python_error&) {
    refuse(argument, "three numbers", given);
  }
  return value;
}

std::string file_of(nb::handle given, const char* argument) {
  if (nb::isinstance<nb::str>(given)) return nb::cast<std::string>(given);
  if (!nb::hasattr(given, "__fspath__")) refuse(argument, "a file's name or path", given);
  return text_of(given.attr("__fspath__")());
}
