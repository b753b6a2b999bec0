// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/spheres_file.hpp>

#include "io/near_word.hpp"
#include "io/note_tally.hpp"

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/limits.hpp>
#include <clearance/io/packed_part.hpp>
#include <clearance/io/text_file.hpp>
#include <clearance/io/write_file.hpp>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace clearance::io {

namespace {

// Checks a YAML file before yaml-cpp makes nodes of it: yaml-cpp keeps the first of two equal keys, reads only the
// first of several documents, and does not know \r as a line end.

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
    level& around = open_.back();
    if (around.key_next && scalar && !around.keys.insert(*scalar).second)
      refuse(file_, "has the key " + io::quoted(*scalar) + " twice", line(mark));
    around.key_next = !around.key_next;
  }

  const std::string& file_;
  const mesh_limits& limits_;
  std::vector<level> open_;
  std::uint64_t values_ = 0;
  int documents_ = 0;
};

/// The only document of a YAML file. Throws std::runtime_error, or YAML::Exception if it is not YAML.
YAML::Node parse_yaml(std::string_view bytes, const std::string& file, const mesh_limits& limits) {
  std::string text;
  for (std::string_view rest = without_mark(bytes); !rest.empty(); text += '\n') text += take_line(rest);
  std::istringstream in(text);
  yaml_keys keys(file, limits);
  for (YAML::Parser parser(in); parser.HandleNextDocument(keys);) {
  }
  return YAML::Load(text);
}

float yaml_number(const YAML::Node& node, const std::string& what, const std::string& file) {
  const auto line = std::size_t(std::max(0, node.Mark().line + 1));
  if (!node.IsScalar()) refuse(file, what + " is not a number", line);
  const auto value = number<float>(node.Scalar());
  if (!value) refuse(file, what + " is " + io::quoted(node.Scalar()) + ", not a number", line);
  return *value;
}

std::size_t yaml_line(const YAML::Node& node) { return std::size_t(std::max(0, node.Mark().line + 1)); }

/// Judges the keys of a map that are not `known`: what may change the spheres is refused, the rest noted.
void judge_yaml_words(const YAML::Node& map, std::string_view known, const std::string& where, const std::string& file,
                      std::vector<std::string>& notes) {
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) refuse(file, where + "has a key that is no word", yaml_line(entry.first));
    const std::string& key = entry.first.Scalar();
    if (has_word(known, key)) continue;
    if (const std::string risk = risk_of(key, known); !risk.empty())
      refuse(file, where + "has the key " + io::quoted(key) + ", which " + risk, yaml_line(entry.first));
    note_once(notes, "has the key " + io::quoted(key) + ", which is not known, and is passed over");
  }
}

/// What cuRobo adds to the radii of each link: one number, or one for each link that is named.
class yaml_buffer {
 public:
  yaml_buffer() = default;
  yaml_buffer(const YAML::Node& given, const std::string& file) {
    if (!given || given.IsNull()) return;
    if (!given.IsMap()) {
      all_ = yaml_number(given, "collision_sphere_buffer", file);
      return;
    }
    for (const auto& entry : given)
      links_[entry.first.IsScalar() ? entry.first.Scalar() : ""] =
          yaml_number(entry.second, "a collision_sphere_buffer", file);
  }
  float of(const std::string& link) const {
    const auto at = links_.find(link);
    return at == links_.end() ? all_ : at->second;
  }
  bool grows() const {
    return all_ != 0 || std::ranges::any_of(links_, [](const auto& each) { return each.second != 0; });
  }

 private:
  float all_ = 0;
  std::map<std::string, float> links_;
};

packed_part yaml_link(const YAML::Node& key, const YAML::Node& list, const yaml_buffer& buffer, const std::string& file,
                      std::vector<std::string>& notes) {
  const std::string& name = key.Scalar();
  const std::string of = "of link " + io::quoted(name);
  if (!list.IsSequence() || list.size() == 0)
    refuse(file, "the spheres " + of + " are no list of spheres", yaml_line(key));
  std::vector<inner_sphere> spheres;
  for (const YAML::Node& each : list) {
    const std::string which = "sphere " + std::to_string(spheres.size()) + ' ' + of;
    if (!each.IsMap()) refuse(file, which + " has no center and radius", yaml_line(each));
    const YAML::Node center = each["center"], radius = each["radius"];
    if (!center || !center.IsSequence() || center.size() != 3)
      refuse(file, which + " has no center of three numbers", yaml_line(each));
    if (!radius) refuse(file, which + " has no radius", yaml_line(each));
    judge_yaml_words(each, "center radius", which + ' ', file, notes);
    float n[3];
    for (std::size_t k = 0; k < 3; ++k) n[k] = yaml_number(center[k], "the center of " + which, file);
    const float r = yaml_number(radius, "the radius of " + which, file) + buffer.of(name);
    spheres.push_back(checked_sphere({n[0], n[1], n[2]}, r, file, which, yaml_line(each)));
  }
  return {.name = name, .spheres = uncertified(std::move(spheres)), .solid = {}, .recipe = {}};
}

/// Words of cuRobo's robot descriptions that do not change the spheres.
constexpr std::string_view curobo_words =
    "robot_cfg kinematics cspace collision_spheres collision_sphere_buffer extra_collision_spheres "
    "self_collision_ignore "
    "self_collision_buffer usd_path usd_robot_root isaac_usd_path usd_flip_joints usd_flip_joint_limits urdf_path "
    "asset_root_path external_asset_path external_robot_configs_path base_link ee_link link_names lock_joints "
    "extra_links "
    "collision_link_names use_global_cumul mesh_link_names add_object_link use_external_assets joint_names";

}  // namespace

std::vector<packed_part> load_spheres_yaml(const std::string& file, const mesh_limits& limits,
                                           std::vector<std::string>* notes) {
  const std::string bytes = read_text(file);
  std::vector<packed_part> parts;
  std::vector<std::string> said;
  std::set<std::string> names;
  std::size_t spheres = 0;

  try {
    YAML::Node at = parse_yaml(bytes, file, limits);
    const auto judge = [&] {
      if (at.IsMap()) judge_yaml_words(at, curobo_words, "", file, said);
    };
    judge();
    for (const char* above : {"robot_cfg", "kinematics"})
      if (at.IsMap() && at[above]) {
        at.reset(at[above]);
        judge();
      }

    if (!at.IsMap() || !at["collision_spheres"]) refuse(file, "has no collision_spheres");
    const YAML::Node links = at["collision_spheres"];
    if (links.IsScalar())
      refuse(file, "its spheres are in another file, " + io::quoted(links.Scalar()) + ": give that one");
    if (!links.IsMap() || links.size() == 0) refuse(file, "its collision_spheres name no link");
    const yaml_buffer buffer(at["collision_sphere_buffer"], file);
    if (buffer.grows()) said.push_back("has a collision_sphere_buffer, which is added to the radii");

    for (const auto& link : links) {
      if (!link.first.IsScalar()) refuse(file, "a link's name is no word");
      const std::string name = link.first.Scalar();
      if (!names.insert(name).second) refuse(file, "has link " + io::quoted(name) + " twice");
      parts.push_back(yaml_link(link.first, link.second, buffer, file, said));
      spheres += parts.back().spheres.spheres.size();
      if (spheres > bytes.size() / 8)  // {center: [0,0,0], radius: 1}; only aliases could pack them tighter
        refuse(file, "repeats its spheres by aliases, more than its size allows");
    }
  } catch (const YAML::Exception& error) {
    refuse(file, "is no YAML: " + error.msg, std::size_t(std::max(0, error.mark.line + 1)));
  }
  if (notes) notes->insert(notes->end(), said.begin(), said.end());
  return parts;
}

void save_spheres_yaml(std::span<const packed_part> parts, const std::string& file) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "collision_spheres" << YAML::Value << YAML::BeginMap;
  for (const packed_part& part : parts) {
    if (!is_utf8(part.name))
      refuse(file, "the name " + io::quoted(part.name) + " is not UTF-8, and YAML cannot hold it");
    out << YAML::Key << YAML::DoubleQuoted << part.name << YAML::Value << YAML::BeginSeq;
    for (const inner_sphere& s : part.spheres.spheres)
      out << YAML::BeginMap << YAML::Key << "center" << YAML::Value << YAML::Flow << YAML::BeginSeq
          << shortest(s.center.x) << shortest(s.center.y) << shortest(s.center.z) << YAML::EndSeq << YAML::Key
          << "radius" << YAML::Value << shortest(s.radius) << YAML::EndMap;
    out << YAML::EndSeq;
  }
  out << YAML::EndMap << YAML::EndMap;
  if (!out.good()) refuse(file, "the spheres cannot be written as YAML: " + out.GetLastError());
  write_bytes(file, std::string(out.c_str()) + '\n');
}

}  // namespace clearance::io
