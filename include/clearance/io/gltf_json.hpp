// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The JSON of a glTF file, read strictly: members that are not known, there twice, or of another kind are refused by
// name.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/limits.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

inline nlohmann::json read_json(std::string_view text, const std::string& file, const mesh_limits& limits = {}) {
  using json = nlohmann::json;
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  std::uint64_t values = 0;
  const auto watch = [&](int depth, json::parse_event_t event, json& parsed) {
    if (depth > 0 && std::size_t(depth) > limits.depth)
      refuse(file, "its JSON has too many values inside one another (mesh_limits::depth)");
    if (++values > limits.values) refuse(file, "its JSON has too many values (mesh_limits::values)");
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      refuse(file, "its JSON has " + io::quoted(parsed.get<std::string>()) + " twice in one object");
    return true;
  };
  try {
    return json::parse(text, watch);
  } catch (const json::parse_error& error) {
    refuse(file, "its JSON is not well-formed at byte " + std::to_string(error.byte));
  } catch (const json::exception&) {  // a number that no double holds
    refuse(file, "its JSON has a value that is out of range");
  }
}

/// A value with its name for sentences, such as: nodes[3].children.
struct gltf_value {
  const nlohmann::json& value;
  const std::string& file;
  std::string name;

  [[noreturn]] void refuse(const std::string& why) const { io::refuse(file, (name.empty() ? "its JSON" : name) + " " + why); }

  const gltf_value& only(std::initializer_list<std::string_view> known) const {
    if (!value.is_object()) refuse("is no object");
    for (const auto& [key, unused] : value.items())
      if (std::ranges::find(known, key) == known.end()) refuse("has a member " + io::quoted(key) + ", which is not known");
    return *this;
  }
  bool has(const char* key) const { return value.contains(key); }
  gltf_value operator[](const char* key) const {
    const auto at = value.is_object() ? value.find(key) : value.end();
    if (at == value.end()) refuse("has no member \"" + std::string(key) + '"');
    return {*at, file, name.empty() ? key : name + "." + key};
  }
  gltf_value operator[](std::size_t i) const { return {value[i], file, name + "[" + std::to_string(i) + "]"}; }

  /// How many values a list has; 0 if it is not there.
  std::size_t size(const char* key) const { return has(key) ? (*this)[key].size() : 0; }
  std::size_t size() const {
    if (!value.is_array()) refuse("is no list");
    return value.size();
  }

  double real() const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) refuse("is no number");
    return value.get<double>();
  }
  std::uint64_t integer() const {
    const double x = real();
    if (!(x >= 0 && x <= 0x1p53 && x == std::floor(x))) refuse("is no whole number from 0");
    return std::uint64_t(x);
  }
  std::uint64_t integer(const char* key, std::uint64_t otherwise) const {
    return has(key) ? (*this)[key].integer() : otherwise;
  }
  /// The number of one of `count` things.
  std::size_t index(std::size_t count) const {
    const std::uint64_t i = integer();
    if (i >= count) refuse("is " + std::to_string(i) + ", of " + std::to_string(count));
    return std::size_t(i);
  }
  template <std::size_t N>
  std::array<double, N> reals() const {
    if (size() != N) refuse("does not have " + std::to_string(N) + " numbers");
    std::array<double, N> made;
    for (std::size_t i = 0; i < N; ++i) made[i] = (*this)[i].real();
    return made;
  }
};

}  // namespace clearance::io
