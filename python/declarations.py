# SPDX-License-Identifier: BSD-3-Clause
"""Reads the questions' headers, so that Python has every question, option, result and sentence that C++ has.

  declarations.py INCLUDE OUTPUT   INCLUDE/clearance/questions/*.hpp -> OUTPUT/declared.hpp, OUTPUT/questions.txt

What is read is what clang-format leaves: a struct at the library's namespace, its documentation above it, one member
declaration a line. Member pointers are written, so a compiler notices what was read wrongly.
"""

import keyword
import pathlib
import re
import sys

STRUCT = re.compile(r"(struct|enum class) (\w+)(?: : ([\w:]+))? \{(.*)")
MEMBER = re.compile(r"  (unsigned long long|[\w:]+(?:<.*>)?) (\w[^()]*?(?:\{.*\})?[^()]*?);(?: +///< (.*))?$")
METHOD = re.compile(r"  (?:const )?([\w:]+(?:<.*?>)?(?:&| )?)\s?(\w+)\((.*?)\) const&? \{")
# What has a class of its own in values.hpp, not one made from its members.
OWN = {"vec3", "position", "distance_certainty"}
# Options that no question has: `uncertain` takes them.
OF_CLOUDS = {"kinect_noise", "stereo_noise", "tof_noise", "lidar_noise"}
# What functions return, and what counts of dropped points are of.
OF_FUNCTIONS = {"motion_clearance_result", "drop_reason", "self_distance_result", "self_clearance"}

# What a member is that a headline or its neighbour explains in C++, for Python's help() of it alone.
MEANS = {
    "state": "What the bracket means for a robot that is about to move.", "distance": "Metres; infinite without a pair.",
    "lower": "Metres: nothing is nearer; 0 if that is not certain.", "upper": "Metres: something certainly is this near.",
    "cloud": "Which cloud of the call; None without a pair.", "point": "Its number in its cloud, as in the input.",
    "part": "The number of the robot's part; None without a pair.", "primitive": "Which sphere or triangle of its part.",
    "at": "The point in the world, metres.", "nearest": "The nearest place on the robot in the world, metres.",
    "normal": "The unit vector from the robot to the point; (0, 0, 0) if there is none.",
    "seen": "How many points or pixels were looked at.", "valid": "How many of them are valid.",
    "counts": "How many points were seen, how many are valid, and why the others are not.",
    "parts": "The answer about each part, in the order of the robot's parts; or how many parts there are.",
    "all": "The answer about all together; or about each part of each configuration, one after another.",
    "of": "One for each configuration, in the shape that the configurations have.",
    "points": "How many points.", "pairs": "Pairs of a point and a part, of each part the nearest first.",
    "per_part": "How many of each part there are at most.", "offsets": "Where each part's begin, and the end of all.",
    "nominal": "As if nothing were uncertain.", "certain": "The pair that is least far apart for certain.",
    "shares": "What the uncertainty is made of, metres.", "calibration": "Of the sensor's pose, metres.",
    "time": "Of the age of the cloud, metres.", "delay": "Of the time until the robot stops, metres.",
    "rounding": "Of float arithmetic, metres.", "uncertain": "How many are perhaps the robot's.",
    "nearest_point": "That point's number in its cloud.", "first_point": "That point's number in its cloud.",
    "min_points": "So many points make a zone count.", "k": "How many of each part.",
    "queries": "How many times were asked.", "to": "Where that piece ends.",
    "first_not_free": "The first of each trajectory that is not free, counted from its beginning.",
    "a": "The number of one part; None without a pair.", "b": "The number of the other, higher one.",
    "sphere_a": "Which sphere of part a, as it was given.", "sphere_b": "Which sphere of part b.",
    "at_b": "The place on sphere b that is nearest to sphere a, in the world, metres.",
    "sum": "All of them together, metres.", "size": "How many configurations there are.",
}


def python_name(name):
    return "".join(word.capitalize() for word in name.split("_"))


def member_name(name):
    return name + "_" * keyword.iskeyword(name)


def declarators(text):
    """The names of `a = 1, b, c[3] = {}`."""
    depth, name, names = 0, "", []
    for c in text + ",":
        depth += (c in "({[<") - (c in ")}]>")
        if c == "," and depth == 0:
            names.append(re.match(r"\s*(\w+)", name)[1])
            name = ""
        else:
            name += c
    return names


def comment(lines, at):
    """The `///` lines that end above line `at`."""
    said = []
    while at > 0 and (m := re.match(r"\s*///(?!<) ?(.*)", lines[at - 1])):
        said.insert(0, m[1])
        at -= 1
    return " ".join(said)


class Declared:
    def __init__(self, kind, name, doc, header):
        self.kind, self.name, self.doc, self.header = kind, name, doc, header
        self.members, self.methods, self.question, self.values, self.out = [], [], False, [], None
        self.base, self.option = None, False  # a struct that a question has as a member is an option of several numbers


def join_member(lines, at):
    """A member's declaration may stand on several lines, and so may what is said about it."""
    text = lines[at]
    while not re.search(r";|\{\s*$|\)\s*$|\}\s*$", text.split("//")[0]) and at + 1 < len(lines):
        at += 1
        code, *said = text.split("  ///< ")
        text = code.rstrip() + " " + lines[at].strip() + ("  ///< " + said[0] if said else "")
    while at + 1 < len(lines) and (m := re.match(r"\s*///< (.*)|\s{6,}/// (.*)", lines[at + 1])) and "///<" in text:
        text += " " + (m[1] or m[2])
        at += 1
    return text, at


def read(header, include):
    lines = header.read_text().splitlines()
    spaces, at = [], 0
    while at < len(lines):
        line = lines[at]
        if m := re.match(r"namespace (\w+(?:::\w+)*) \{", line):
            spaces.append(m[1])
        elif line.startswith("}  // namespace"):
            spaces.pop()
        elif spaces == ["clearance"] and (m := STRUCT.match(line)) and not lines[at - 1].startswith(("template", "  requires")):
            made = Declared(m[1], m[2], comment(lines, at), header.relative_to(include))
            made.base = m[3]
            if m[1] == "enum class":
                text = m[4]
                while "}" not in text:
                    at += 1
                    text += lines[at].split("//")[0]
                made.values = re.findall(r"\w+", text.split("}")[0])
            else:
                at = read_members(lines, at + 1, made)
            yield made
        at += 1


def read_members(lines, at, made):
    seen = True  # until `private:`
    while not lines[at].startswith("}"):
        line = lines[at]
        if re.match(r" (private|protected):", line):
            seen = False
        elif line.startswith("  using result = "):
            made.question = True
        elif m := re.match(r"  using (out|searched) = (.*?);", line):
            made.out = m[2] if m[1] == "out" else "of*"
        elif line == "  static constexpr bool each_part = true;":
            made.out = "all*"  # of each part of each configuration, where a configuration has `of`
        elif line == "  struct out {":
            made.out = []
            while lines[at := at + 1] != "  };":
                made.out.append(lines[at])
        elif seen and (m := METHOD.match(line)) and re.fullmatch(r"((std::size_t|double|real) \w+(, )?)*", m[3]):
            if not lines[at - 1].strip().startswith("template"):
                made.methods.append((m[2], comment(lines, at), m[3].split(", ") if m[3] else []))
        elif seen and re.match(r"  [\w:]", line) and not re.match(r"  (using|static|template|struct|class|requires|friend|CLEARANCE)\b", line):
            text, at = join_member(lines, at)
            if m := MEMBER.match(text):
                said = m[3] or comment(lines, at)
                made.members += [(name, m[1], said if i == 0 else "") for i, name in enumerate(declarators(m[2]))]
        at += 1
    return at


def words(text):
    return set(re.findall(r"\w+", text))


def quoted(text):
    for ours, pythons in (("std::invalid_argument", "ValueError"), ("std::out_of_range", "IndexError"), ("Throws", "Raises")):
        text = text.replace(ours, pythons)
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("`", "") + '"'


def out_arrays(out, all_of, to="to"):
    """The (name, expression) of each array where a device writes: the pointers of `out`, and of what it is made of."""
    if isinstance(out, str):
        if out.endswith("*"):
            return [(out[:-1] if out in ("of*", "all*") else "result", to)]
        return out_arrays(all_of[out.split("::")[0]].out, all_of, to)
    arrays = []
    for line in out:
        if m := re.match(r"\s+(?:const )?[\w: ]+\* (\w+)(?: = nullptr)?;", line):
            arrays.append((m[1], f"{to}.{m[1]}"))
        elif (m := re.match(r"\s+(\w+) (\w+);", line)) and m[1] in all_of:
            header = (include_folder / all_of[m[1]].header).read_text()
            body = header[header.index(f"struct {m[1]} {{"):].split("\n};")[0].splitlines()[1:]
            arrays += out_arrays(body, all_of, f"{to}.{m[2]}")
    return arrays


def take_from_base(d, all_of):
    if d.base in all_of:
        take_from_base(all_of[d.base], all_of)
        d.members, d.base = all_of[d.base].members + d.members, None


def reachable(all_of):
    wanted = [d for d in all_of.values() if d.question or d.name in OF_CLOUDS | OF_FUNCTIONS]
    chosen = {}
    for name in OF_CLOUDS:
        all_of[name].option = True
    while wanted:
        d = wanted.pop()
        if d.name in chosen or d.name in OWN:
            continue
        chosen[d.name] = d
        take_from_base(d, all_of)
        for _, kind, _ in d.members:
            wanted += [all_of[w] for w in words(kind) if w in all_of]
            if d.question and kind in all_of and all_of[kind].kind == "struct" and kind not in OWN:
                all_of[kind].option = True
        if d.question:
            text = (include_folder / d.header).read_text()
            own = re.search(rf"^struct {d.name} [:\w ]*\{{", text, re.MULTILINE).start()
            result = re.search(r"using result = (.*);", text[own:])[1]
            wanted += [all_of[w] for w in words(result) if w in all_of]
    return [d for d in all_of.values() if d.name in chosen]


def write(chosen, all_of, output):
    headers = sorted({str(d.header) for d in chosen})
    text = "// Written by declarations.py from the headers' own words.\n#pragma once\n\n"
    text += "".join(f"#include <{h}>\n" for h in headers)
    text += '\n#include "declared_as.hpp"\n\n#include <tuple>\n\nusing clearance::real;\n\n'
    for d in chosen:
        if d.kind == "enum class":
            values = ", ".join(f"value_as<clearance::{d.name}>{{{quoted(v)}, clearance::{d.name}::{v}}}" for v in d.values)
            text += (f"template <>\nstruct declared<clearance::{d.name}> {{\n"
                     f"  static constexpr const char *name = {quoted(python_name(d.name))}, *doc = {quoted(d.doc)};\n"
                     f"  static constexpr bool question = false, option = false;\n"
                     f"  static constexpr auto values = std::make_tuple({values});\n}};\n")
            continue
        members = ", ".join(f"member_as{{{quoted(member_name(name))}, &clearance::{d.name}::{name}, {quoted(said or MEANS.get(name, ''))}}}"
                            for name, _, said in d.members)
        methods = ", ".join(
            f"method_as{{{quoted(name)}, [](const clearance::{d.name}& r{''.join(', ' + a for a in given)})"
            f" {{ return r.{name}({', '.join(a.split()[1] for a in given)}); }}, {quoted(said or MEANS.get(name, ''))}"
            f"{''.join(', ' + quoted(a.split()[1]) for a in given)}}}"
            for name, said, given in d.methods if not d.question)
        text += (f"template <>\nstruct declared<clearance::{d.name}> {{\n"
                 f"  static constexpr const char *name = {quoted(python_name(d.name))}, *doc = {quoted(d.doc)};\n"
                 f"  static constexpr bool question = {str(d.question).lower()}, option = {str(d.option).lower()};\n"
                 f"  static constexpr auto members = std::make_tuple({members});\n"
                 f"  static constexpr auto methods = std::make_tuple({methods});\n")
        if d.question and d.out:
            arrays = ", ".join(f"out_as{{{quoted(name)}, [](auto& to) -> auto& {{ return {at}; }}}}"
                               for name, at in out_arrays(d.out, all_of))
            text += f"  static constexpr auto out = std::make_tuple({arrays});\n"
        text += "};\n"
    text += "\n/// Calls `f.template operator()<T>()` for each.\ntemplate <class F>\nvoid for_each_declared(F f) {\n"
    text += "".join(f"  f.template operator()<clearance::{d.name}>();\n" for d in chosen)
    text += "}\n"
    put(output / "declared.hpp", text)
    questions = [d for d in chosen if d.question]
    put(output / "questions.txt", "".join(f"{d.name} {d.header}\n" for d in questions))


def put(file, text):
    """Only what differs is written, so that nothing is compiled again for nothing."""
    if not file.exists() or file.read_text() != text:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)


if __name__ == "__main__":
    include_folder, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    found = {}
    for path in sorted((include_folder / "clearance").rglob("*.hpp")):
        if "io" not in path.parts:
            found |= {d.name: d for d in read(path, include_folder)}
    write(reachable(found), found, out)
