// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Checks a YAML file before yaml-cpp makes nodes of it: yaml-cpp keeps the first of two equal keys, reads only the
// first of several documents, and does not know \r as a line end.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/limits.hpp>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <set>
#include <sstream>
#include <vector>

namespace clearance::io {

namespace detail {

/// Refuses a map with a duplicate key, and more values than the limit. It sees each event of the file once, even if an
/// alias repeats it.
class yaml_keys final : public YAML::EventHandler {
 public:
  yaml_keys(const std::string& file, const mesh_limits& limits) : file_(file), limits_(limits) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) refuse(file_, "has more than one YAML document", line(mark));
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { node(mark, ""); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { node(mark, {}); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string& value) override {
    node(mark, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    node(mark, {});
    open_.push_back({});
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    node(mark, {});
    open_.push_back({.map = true});
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  struct level {
    bool map = false, key_next = true;
    std::set<std::string> keys = {};
  };

  static std::size_t line(const YAML::Mark& mark) { return std::size_t(std::max(0, mark.line + 1)); }

  void node(const YAML::Mark& mark, const std::optional<std::string>& scalar) {
    if (++values_ > limits_.values)
      refuse(file_, "has more than " + std::to_string(limits_.values) + " YAML values (mesh_limits::values)",
             line(mark));
    if (open_.empty() || !open_.back().map) return;
    level& here = open_.back();
    if (here.key_next && scalar && !here.keys.insert(*scalar).second)
      refuse(file_, "has the key " + io::quoted(*scalar) + " twice", line(mark));
    here.key_next = !here.key_next;
  }

  const std::string& file_;
  const mesh_limits& limits_;
  std::vector<level> open_;
  std::uint64_t values_ = 0;
  int documents_ = 0;
};

}  // namespace detail

/// The only document of a YAML file. Throws std::runtime_error, or YAML::Exception if it is not YAML.
inline YAML::Node parse_yaml(std::string_view bytes, const std::string& file, const mesh_limits& limits) {
  std::string text;
  for (std::string_view rest = without_mark(bytes); !rest.empty(); text += '\n') text += take_line(rest);
  std::istringstream in(text);
  detail::yaml_keys keys(file, limits);
  for (YAML::Parser parser(in); parser.HandleNextDocument(keys);) {
  }
  return YAML::Load(text);
}

}  // namespace clearance::io
