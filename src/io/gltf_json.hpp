// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The JSON of a glTF file, read strictly: members that are unknown, duplicate or of a wrong kind are refused by name.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/limits.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

/// Checks JSON before a tree is made of it: its size, its depth, and members that are there twice.
class json_check final : public nlohmann::json_sax<nlohmann::json> {
 public:
  json_check(const std::string& file, const mesh_limits& limits) : file_(file), limits_(limits) {}

  bool null() override { return count(); }
  bool boolean(bool) override { return count(); }
  bool number_integer(std::int64_t) override { return count(); }
  bool number_unsigned(std::uint64_t) override { return count(); }
  bool number_float(double, const std::string&) override { return count(); }
  bool string(std::string&) override { return count(); }
  bool binary(nlohmann::json::binary_t&) override { return count(); }
  bool start_object(std::size_t) override { return open(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(std::string& name) override {
    if (!keys_.back().insert(name).second) refuse(file_, "its JSON has " + io::quoted(name) + " twice in one object");
    return true;
  }
  bool parse_error(std::size_t at, const std::string&, const nlohmann::json::exception& error) override {
    if (error.id == 406) refuse(file_, "its JSON has a number that no double holds, at byte " + std::to_string(at));
    refuse(file_, "its JSON is not well-formed at byte " + std::to_string(at));
  }

 private:
  bool count() {
    if (++values_ > limits_.values) refuse(file_, "its JSON has too many values (mesh_limits::values)");
    return true;
  }
  bool open() {
    if (keys_.size() > limits_.depth)
      refuse(file_, "its JSON has too many values inside one another (mesh_limits::depth)");
    keys_.emplace_back();
    return count();
  }
  bool close() {
    keys_.pop_back();
    return true;
  }

  const std::string& file_;
  const mesh_limits& limits_;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
  std::uint64_t values_ = 0;
};

inline nlohmann::json read_json(std::string_view text, const std::string& file, const mesh_limits& limits = {}) {
  json_check check(file, limits);
  nlohmann::json::sax_parse(text, &check);  // with nlohmann's callbacks the time would grow with the square
  return nlohmann::json::parse(text);
}

/// A value with its name for error sentences, such as nodes[3].children.
struct gltf_value {
  const nlohmann::json& value;
  const std::string& file;
  std::string name;

  [[noreturn]] void refuse(const std::string& why) const {
    io::refuse(file, (name.empty() ? "its JSON" : name) + " " + why);
  }

  const gltf_value& only(std::initializer_list<std::string_view> known) const {
    if (!value.is_object()) refuse("is no object");
    for (const auto& [key, unused] : value.items())
      if (std::ranges::find(known, key) == known.end())
        refuse("has a member " + io::quoted(key) + ", which is not known");
    return *this;
  }
  bool has(const char* key) const { return value.contains(key); }
  gltf_value operator[](const char* key) const {
    const auto at = value.is_object() ? value.find(key) : value.end();
    if (at == value.end()) refuse("has no member \"" + std::string(key) + '"');
    return {*at, file, name.empty() ? key : name + "." + key};
  }
  gltf_value operator[](std::size_t i) const { return {value[i], file, name + "[" + std::to_string(i) + "]"}; }

  /// How many values a list has; 0 if there is no list.
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
  /// The value as the number of one of `count` things.
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
