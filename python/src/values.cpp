// SPDX-License-Identifier: BSD-3-Clause
#include "values.hpp"

#include <nanobind/stl/vector.h>

#include <algorithm>

nb::object dtype_of_members(const nb::list& names, const nb::list& formats, const nb::list& offsets, std::size_t size) {
  nb::dict of;
  of["names"] = names, of["formats"] = formats, of["offsets"] = offsets, of["itemsize"] = size;
  return nb::module_::import_("numpy").attr("dtype")(of);
}

std::string repr_of(nb::handle object, const char* name, std::span<const char* const> members) {
  std::string text = std::string(name) + '(';
  for (const char* const member : members) {
    const nb::object value = object.attr(member);
    std::string shown;
    if (nb::hasattr(value, "shape") && nb::hasattr(value, "dtype"))
      shown = "<" + std::to_string(nb::len(value)) + " values>";
    else if (nb::isinstance<nb::float_>(value))
      shown = nb::cast<std::string>(nb::str("{:.6g}").attr("format")(value));
    else
      shown = nb::cast<std::string>(nb::repr(value));
    text += (text.back() == '(' ? "" : ", ") + std::string(member) + '=' + shown;
  }
  return text + ')';
}

nb::dict dict_of(nb::handle object, std::span<const char* const> members) {
  nb::dict all;
  for (const char* const member : members) {
    const nb::object value = object.attr(member);
    if (nb::hasattr(value, "to_dict"))
      all[member] = value.attr("to_dict")();
    else if (nb::hasattr(value, "dtype"))
      all[member] = value.attr("copy")();
    else if (PyLong_Check(value.ptr()) && nb::hasattr(value, "name"))
      all[member] = value.attr("name");
    else
      all[member] = value;
  }
  if (nb::hasattr(object, "link")) all["link"] = object.attr("link");
  return all;
}

std::size_t part_of(nb::handle given, const char* argument, const part_names& names) {
  if (!nb::isinstance<nb::str>(given)) return index_of(given, argument);
  const auto name = nb::cast<std::string>(given);
  for (std::size_t k = 0; names && k < names->size(); ++k)
    if ((*names)[k] == name) return k;
  std::string text = "clearance: the robot has no part \"" + name + "\"";
  constexpr std::size_t most = 12;
  for (std::size_t k = 0; names && k < std::min(names->size(), most); ++k)
    text += (k == 0 ? "; it has \"" : ", \"") + (*names)[k] + '"';
  throw std::invalid_argument(text + (names && names->size() > most ? " and others" : ""));
}

nb::tuple kept_of(const asked_about& about) {
  nb::object names = nb::none();
  if (about.names) names = nb::cast(*about.names);
  return nb::make_tuple(names, nb::bytes(about.poses.bytes.data(), about.poses.bytes.size()), nb::cast(about.shape));
}

asked_about about_of(const nb::tuple& kept) {
  asked_about made;
  if (!kept[0].is_none())
    made.names = std::make_shared<const std::vector<std::string>>(nb::cast<std::vector<std::string>>(kept[0]));
  const auto digest = nb::cast<nb::bytes>(kept[1]);
  if (digest.size() == made.poses.bytes.size()) std::memcpy(made.poses.bytes.data(), digest.data(), digest.size());
  made.shape = nb::cast<std::vector<std::size_t>>(kept[2]);
  return made;
}
