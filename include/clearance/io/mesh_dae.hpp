// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What must hold of a COLLADA file before assimp reads it: assimp 5.2 reads beyond the end of arrays that are too
// short, reserves whatever a count says, goes round for ever where an index is no number, and follows nodes that
// contain themselves until the stack ends.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/xml_scan.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

/// The nodes of a COLLADA file and which contain which, directly or by instance_node.
class dae_nodes {
 public:
  void add(const xml_tag& tag) {
    while (!open_.empty() && nodes_[open_.back()].depth >= tag.depth) open_.pop_back();
    if (tag.element == "node") {
      if (!open_.empty()) nodes_[open_.back()].inside.push_back(nodes_.size());
      nodes_.push_back({tag.depth, {}, {}, 0, 0, false});
      if (const auto id = tag.attribute("id"); !id.empty()) by_id_["#" + std::string(id)] = nodes_.size() - 1;
      open_.push_back(nodes_.size() - 1);
    } else if (tag.element == "instance_node" && !open_.empty()) {
      nodes_[open_.back()].instances.emplace_back(tag.attribute("url"));
    }
  }

  /// A node inside itself, more than 200 inside one another, or more than a million in all, are errors.
  void check(const std::string& file) {
    double all = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) all += measure(i, file, 0).size;
    if (!(all < 1e6)) refuse(file, "its nodes contain one another more than a million times");
  }

 private:
  struct node {
    std::size_t depth;
    std::vector<std::size_t> inside;
    std::vector<std::string> instances;
    double size;         // of all it contains, itself included; 0 if not yet known
    std::size_t height;  // of the same
    bool entered;
  };

  node& measure(std::size_t i, const std::string& file, int level) {
    node& n = nodes_[i];
    if (n.size > 0) return n;
    if (n.entered) refuse(file, "a node contains itself");
    n.entered = true;
    double size = 1;
    const auto add = [&](std::size_t child) {
      const node& c = level < 200 ? measure(child, file, level + 1) : n;
      if (level >= 200 || c.height >= 200) refuse(file, "has more than 200 nodes inside one another");
      size += c.size;
      n.height = std::max(n.height, c.height + 1);
    };
    for (const std::size_t child : n.inside) add(child);
    for (const auto& url : n.instances)
      if (const auto found = by_id_.find(url); found != by_id_.end()) add(found->second);
    n.size = size;
    return n;
  }

  std::vector<node> nodes_;
  std::vector<std::size_t> open_;
  std::map<std::string, std::size_t> by_id_;
};

/// Ends with a sentence where a COLLADA file has what would make assimp read wrong values or exhaust memory or stack.
inline void check_dae(std::string_view bytes, const std::string& file) {
  struct accessor {
    std::string source;
    double needed;
    std::size_t line;
  };
  std::vector<accessor> accessors;
  std::map<std::string, double> arrays;
  dae_nodes nodes;
  scan_xml(bytes, file, [&](const xml_tag& tag) {
    if (tag.depth == 0 && tag.element != "COLLADA") refuse(file, "is not a COLLADA file", tag.line);
    if (const auto metres = tag.attribute("meter"); tag.element == "unit" && !metres.empty()) {
      const auto value = number<double>(metres);
      if (!value || !(*value > 0) || !std::isfinite(*value))
        refuse(file, "the unit of " + std::string(metres.substr(0, 40)) + " metres is no length", tag.line);
    }
    const auto counted = [&](const char* name, std::uint64_t otherwise) {
      const auto word = tag.attribute(name);
      const auto value = number<std::uint64_t>(word);
      if (!word.empty() && !(value && *value <= bytes.size()))
        refuse(file,
               std::string("the ") + name + " of " + std::string(word.substr(0, 40)) + " is more than the file holds",
               tag.line);
      return double(value.value_or(otherwise));
    };
    const double count = counted("count", 0), offset = counted("offset", 0);
    if (tag.element == "input" && offset > 31) refuse(file, "an input has an offset above 31", tag.line);
    if (tag.element == "triangles" && 6 * count > double(bytes.size()))  // each has three indices
      refuse(file, "says it has more triangles than the file holds", tag.line);
    if (tag.element.ends_with("_array")) arrays["#" + std::string(tag.attribute("id"))] = count;
    if (tag.element == "accessor")
      accessors.push_back({std::string(tag.attribute("source")), offset + count * counted("stride", 1), tag.line});
    const bool indices = tag.element == "p" || tag.element == "h" || tag.element == "v" || tag.element == "vcount";
    if (indices && tag.content.find_first_not_of("0123456789- \t\r\n") != std::string_view::npos)
      refuse(file, "a list of indices has something in it that is no number", tag.line);
    nodes.add(tag);
  });
  for (const auto& [source, needed, line] : accessors)
    if (const auto array = arrays.find(source); array != arrays.end() && needed > array->second)
      refuse(file, "an accessor needs more values than the array " + source.substr(0, 80) + " has", line);
  nodes.check(file);
}

}  // namespace clearance::io
