# SPDX-License-Identifier: BSD-3-Clause
"""Damages of a URDF by its words: what URDF does not define, with and without geometry in it; names misspelt; sizes of 0; xacro under another
prefix; the same package written otherwise; a joint that follows one of another file; what is there twice."""

import re

import xml_tree
from strict import Invalid, Unknown

_BOX = b'<geometry><box size="0.4 0.4 0.4"/></geometry>'
_UNKNOWN = [b"controller_gains", b"traits", b"gravity", b"kinematic", b"anchor", b"foo", b"u:foo", b"frame", b"physics", b"collision_margin", b"origin_of_all"]
_OFTEN = [b"self_filter", b"self_collision_checking", b"collision_checking", b"contact", b"inertia", b"sensor", b"gazebo", b"material"]
_LIKE = [b"colision", b"Collision", b"collisions", b"u:collision", b"visul", b"u:visual", b"visual_2", b"geometery", b"my_geometry", b"lnk", b"Joint", b"u:joint", b"include"]
_INSIDE = [b"", b'<a b="1"/>', b"text", _BOX, b"<collision>" + _BOX + b"</collision>", b"<visual>" + _BOX + b"</visual>", b'<link name="z"/>', b'<joint name="turn"/>',
           b'<origin xyz="0 0 1"/>', b'<mesh filename="m.stl"/>']
_ATTRIBUTES = [b'command_effort="1"', b'dont_collapse="true"', b'rpy="0 0 0"', b'xzy="0.1 0 0"', b'rpi="0 0 0"', b'scal="2 2 2"', b'raduis="0.3"', b'XYZ="0.1 0 0"', b'power_on="1"',
               b'u:xyz="1 2 3"', b'quat_xyzw="0 0 0 1"', b'id="5"', b'lenght="1"', b'lower_velocity="1"']
_TEXTS = [b"a remark", b"# z = 0.5", b"0.1 0 0", b'origin xyz="0.1 0 0"/>', b"&lt;origin/&gt;", b"-->", b"<![CDATA[<origin xyz='1 0 0'/>]]>"]


def _misspelt(rng, word):
    at = rng.randrange(len(word))
    return rng.choice([word[:at] + word[at + 1:], word[:at] + b"x" + word[at + 1:], word[:at] + word[at:at + 1] + word[at:], word.upper(), word.capitalize(),
                       word[:at] + word[at + 1:at + 2] + word[at:at + 1] + word[at + 2:], b"u:" + word, b"my_" + word, word + b"s", word[:at] + b":" + word[at:]])


def damage(rng, data):
    try:
        elements = list(xml_tree.parse(data).walk())
    except (Invalid, Unknown):
        return data + b" "
    element = rng.choice(elements)
    head_end = element.begin + re.match(rb"<[^>]*>", data[element.begin:]).end()
    head, name = data[element.begin:head_end], element.name.encode()
    kind = rng.randrange(8)
    if kind <= 2:  # put something in
        at = rng.choice([e.begin for e in elements[1:]] or [head_end])  # before an element, so in the one around it
        if kind == 0:
            return data[:at] + rng.choice(_TEXTS) + data[at:]
        new = rng.choice(rng.choice([_UNKNOWN, _UNKNOWN, _OFTEN, _LIKE]))
        return data[:at] + b"<" + new + rng.choice([b"", b' name="q"']) + b">" + rng.choice(_INSIDE) + b"</" + new + b">" + data[at:]
    if kind == 3:
        return data[:element.begin] + head.replace(name, name + b" " + rng.choice(_ATTRIBUTES), 1) + data[head_end:]
    if kind == 4:  # misspell an element, or one of its attributes
        found = list(re.finditer(rb"\s([\w:]+)\s*=", head))
        if found and rng.random() < 0.5:
            at = rng.choice(found)
            return data[:element.begin] + head[:at.start(1)] + _misspelt(rng, at[1]) + head[at.end(1):] + data[head_end:]
        whole, new = data[element.begin:element.end], _misspelt(rng, name)
        return data[:element.begin] + re.sub(rb"(</?)" + name + rb"(?=[\s/>])", rb"\1" + new, whole) + data[element.end:]
    if kind == 5:  # sizes and other numbers of 0
        sized = list(re.finditer(rb'(size|radius|length|scale)="([^"]*)"', data))
        if not sized:
            return data + b"\n"
        at = rng.choice(sized)
        words = at[2].split()
        for k in range(len(words)):
            if rng.random() < 0.6:
                words[k] = rng.choice([b"0", b"0", b"0.0", b"-0", b"-0.1", b"1e-9"])
        return data[:at.start(2)] + b" ".join(words) + data[at.end(2):]
    if kind == 6:
        return rng.choice([
            data.replace(b"<robot", b'<robot xmlns:x="http://www.ros.org/wiki/xacro"', 1).replace(b"</robot>", rng.choice([b"", b"<x:include filename='a'/>", b"<x:a/>"]) + b"</robot>"),
            data.replace(b"<robot", b'<robot xmlns="http://www.ros.org" xmlns:u="urn:u"', 1), data.replace(b'filename="', b'filename="package:///x/', 1),
            data.replace(b'filename="', b'filename="package://none/', 1), b"\n\n" + data, re.sub(rb'<robot name="[^"]*"', b"<robot", data)])
    if rng.random() < 0.5:
        return re.sub(rb'mimic joint="[^"]*"', b'mimic joint="' + rng.choice([b"of_another_file", b"tur", b"bow", b"turnx", b""]) + b'"', data)
    return data[:element.end] + data[element.begin:element.end] + data[element.end:]  # twice
