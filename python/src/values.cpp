// SPDX-License-Identifier: BSD-3-Clause
#include "values.hpp"

#include <cmath>
#include <cstdio>

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

std::string sentence_of(const clearance::min_distance_result& r, const part_names& names) {
  const auto grouped = [](std::uint64_t n) {
    std::string text = std::to_string(n);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
    return text;
  };
  char metres[96];
  std::string text = clearance::to_string(r.state);
  if (r.state == clearance::state::no_data) return text + ": none of " + grouped(r.seen) + " points is valid";
  const double distance = std::abs(r.distance) < 0.0005f ? 0 : double(r.distance);  // not -0.000
  std::snprintf(metres, sizeof metres, ": %.3f m (certainly %.3f to %.3f)", distance, double(r.lower), double(r.upper));
  text += metres;
  if (r.part == clearance::none) return text;
  text += ", " + (names && r.part < names->size() ? (*names)[r.part] : "part " + std::to_string(r.part));
  if (r.cloud != 0)
    text += " to cloud " + std::to_string(r.cloud) + ",";
  else
    text += " to";
  return text + " point " + grouped(r.point);
}
