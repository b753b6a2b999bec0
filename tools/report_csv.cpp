// SPDX-License-Identifier: BSD-3-Clause
#include "report_csv.hpp"
#include <clearance/io/sentence.hpp>

#include <cmath>

using namespace clearance;

std::string csv_word(const json& value, double number) {
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  if (value.is_null()) return {};
  if (!value.is_string()) return value.dump();
  std::string text = io::printable(value.get<std::string>());
  if (text.find_first_of(",\"") == text.npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != text.npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}

std::string witness_cells(const min_distance_result& r, const observation* cloud, std::uint32_t point,
                          const std::vector<body>& bodies) {
  const json row = witness(r, cloud, point, bodies);
  const bool any = r.state != state::no_data;
  std::string out = to_string(r.state);
  for (const auto& [name, value] :
       {std::pair("distance", double(r.distance)), {"lower", double(r.lower)}, {"upper", double(r.upper)}})
    out += ',' + csv_word(row[name], any ? value : 0);
  for (const char* name : {"cloud", "point", "part", "primitive"}) out += ',' + csv_word(row[name]);
  for (const char* name : {"point_xyz", "nearest_xyz"})
    for (int i = 0; i < 3; ++i) out += ',' + (row[name].is_null() ? std::string() : row[name][i].dump());
  return out;
}
