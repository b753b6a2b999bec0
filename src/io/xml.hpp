// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Parses XML by expat, which accepts exactly what the standard accepts, into a tree that is read strictly: every reader
// lists the attributes and children it knows, and others are refused by name.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/limits.hpp>

#include <expat.h>

#include <algorithm>
#include <array>
#include <exception>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearance::io {

struct xml_element {
  std::string name, text;  // text: directly in it, not in its children
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<xml_element> children;
  std::size_t line = 0;

  const std::string* attribute(std::string_view wanted) const {
    for (const auto& [key, value] : attributes)
      if (key == wanted) return &value;
    return nullptr;
  }
  /// Is the content equal, wherever it stands?
  bool same(const xml_element& other) const {
    return name == other.name && text == other.text && attributes == other.attributes &&
           std::ranges::equal(children, other.children, [](const auto& a, const auto& b) { return a.same(b); });
  }
};

/// May a name have a prefix that no xmlns declares? The standard allows it; other readers of a format may accept it.
enum class xml_prefixes { declared, any };

/// Reads one document. Refuses one that is not well-formed, declares a document type (and so entities), or exceeds the
/// limits.
class xml_reader {
 public:
  xml_reader(const std::string& file, const mesh_limits& limits, xml_prefixes prefixes)
      : file_(file), limits_(limits), prefixes_(prefixes) {}

  xml_element read(std::string_view bytes) {
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                              &XML_ParserFree);
    if (!parser) throw std::bad_alloc();

    parser_ = parser.get();
    XML_SetUserData(parser_, this);
    XML_SetElementHandler(
        parser_,
        [](void* self, const char* name, const char** with) { static_cast<xml_reader*>(self)->begin(name, with); },
        [](void* self, const char*) { static_cast<xml_reader*>(self)->end(); });
    XML_SetCharacterDataHandler(parser_, [](void* self, const char* text, int size) {
      auto& reader = *static_cast<xml_reader*>(self);
      reader.guarded([&] { reader.open_.back()->text.append(text, std::size_t(size)); });
    });
    XML_SetStartDoctypeDeclHandler(parser_, [](void* self, const char*, const char*, const char*, int) {
      static_cast<xml_reader*>(self)->guarded([&] { throw "it declares a document type, which is not supported"; });
    });

    constexpr std::size_t piece = 1 << 24;  // expat counts in int
    for (bool last = false; !last; bytes.remove_prefix(std::min(piece, bytes.size()))) {
      last = bytes.size() <= piece;
      const auto status = XML_Parse(parser_, bytes.data(), int(std::min(piece, bytes.size())), last);
      if (thrown_) std::rethrow_exception(thrown_);
      if (why_) refuse(file_, why_, line());
      if (status != XML_STATUS_OK)
        refuse(file_, std::string("is no well-formed XML: ") + XML_ErrorString(XML_GetErrorCode(parser_)), line());
    }
    return std::move(above_.children.front());
  }

 private:
  std::size_t line() const { return std::size_t(XML_GetCurrentLineNumber(parser_)); }

  /// Catches what `act` throws: nothing may be thrown through expat, which is C.
  template <class Act>
  void guarded(Act act) {
    if (thrown_ || why_) return;
    try {
      act();
      return;
    } catch (const char* why) {
      why_ = why;
    } catch (...) {
      thrown_ = std::current_exception();
    }
    XML_StopParser(parser_, XML_FALSE);
  }

  void begin(const char* name, const char** with) {
    guarded([&] {
      if (open_.size() > limits_.depth) throw "has too many elements inside one another (mesh_limits::depth)";
      xml_element& made = open_.back()->children.emplace_back();
      made.name = name;
      made.line = line();
      for (; *with; with += 2, ++values_) made.attributes.emplace_back(with[0], with[1]);
      for (const auto& [key, value] : made.attributes)
        if (key.starts_with(declares)) ++declared_[key.substr(declares.size())];
      check_prefix(made.name);
      for (const auto& [key, value] : made.attributes) check_prefix(key);
      if (++values_ > limits_.values) throw "has too many elements and attributes (mesh_limits::values)";
      open_.push_back(&made);  // stays valid while it is open: nothing is added beside it
    });
  }

  void end() {
    guarded([&] {
      for (const auto& [key, value] : open_.back()->attributes)
        if (const auto at = key.starts_with(declares) ? declared_.find(key.substr(declares.size())) : declared_.end();
            at != declared_.end() && --at->second == 0)
          declared_.erase(at);
      open_.pop_back();
    });
  }

  /// Prefixes of other vocabularies are declared; in a damaged name a prefix is an accident.
  void check_prefix(const std::string& name) const {
    const std::size_t colon = name.find(':');
    if (prefixes_ == xml_prefixes::any || colon == name.npos || name.starts_with("xml:") || name.starts_with(declares))
      return;
    if (!declared_.contains(name.substr(0, colon))) throw "uses a prefix that is not declared";
  }

  static constexpr std::string_view declares = "xmlns:";

  const std::string& file_;
  const mesh_limits& limits_;
  const xml_prefixes prefixes_;
  XML_Parser parser_ = nullptr;
  xml_element above_;
  std::vector<xml_element*> open_{&above_};
  std::map<std::string, std::size_t> declared_;  // prefixes, by how many open elements declare them
  std::uint64_t values_ = 0;
  std::exception_ptr thrown_;
  const char* why_ = nullptr;
};

inline xml_element read_xml(std::string_view bytes, const std::string& file, const mesh_limits& limits = {},
                            xml_prefixes prefixes = xml_prefixes::declared) {
  return xml_reader(file, limits, prefixes).read(bytes);
}

/// An element with its context for error sentences: its file, and the link, joint or geometry that contains it.
struct xml_place {
  const xml_element& element;
  const std::string& file;
  std::string owner;  // such as link "arm"

  [[noreturn]] void refuse(const std::string& why) const {
    io::refuse(file, (owner.empty() ? "" : owner + ": ") + "<" + element.name.substr(0, 60) + "> " + why, element.line);
  }
  xml_place in(const xml_element& child) const { return {child, file, owner}; }

  /// Refuses attributes and children that are not listed, and text between children. Names with a colon belong to other
  /// vocabularies, so they pass.
  void only(std::initializer_list<std::string_view> attributes,
            std::initializer_list<std::string_view> children) const {
    const auto known = [](auto& list, const std::string& name) {
      return std::ranges::find(list, name) != list.end() || name.find(':') != name.npos || name == "xmlns";
    };
    for (const auto& [name, value] : element.attributes)
      if (!known(attributes, name)) refuse("has an attribute " + io::quoted(name) + ", which is not known");
    for (const auto& child : element.children)
      if (!known(children, child.name)) in(child).refuse("is not known in <" + element.name + ">");
    no_text();
  }
  void no_text() const {
    if (const auto at = element.text.find_first_not_of(" \t\r\n"); at != element.text.npos)
      refuse("has text in it: " + io::quoted(std::string_view(element.text).substr(at, 40)));
  }

  /// The child with that name, or null; two that differ are an error.
  const xml_element* child(std::string_view name) const {
    const xml_element* found = nullptr;
    for (const auto& each : element.children) {
      if (each.name != name) continue;
      if (found && !each.same(*found)) in(each).refuse("is there twice");
      found = &each;
    }
    return found;
  }
  const std::string& attribute(std::string_view name) const {
    const std::string* value = element.attribute(name);
    if (!value) refuse("has no attribute \"" + std::string(name) + '"');
    return *value;
  }

  /// Exactly N finite numbers from an attribute, and nothing else in it.
  template <std::size_t N>
  std::array<double, N> numbers(std::string_view name) const {
    std::string_view rest = attribute(name);
    std::array<double, N> made{};
    const auto wrong = [&] {
      refuse("has the " + std::string(name) + " " + io::quoted(attribute(name)) + ", which is not " +
             (N == 1 ? "one finite number" : std::to_string(N) + " finite numbers"));
    };
    for (double& each : made) {
      const auto value = number<double>(take_word(rest, " \t\r\n"));
      if (!value || !std::isfinite(*value)) wrong();
      each = *value;
    }
    if (!take_word(rest, " \t\r\n").empty()) wrong();
    return made;
  }
  double number_or(std::string_view name, double otherwise) const {
    return element.attribute(name) ? numbers<1>(name)[0] : otherwise;
  }
};

}  // namespace clearance::io
