# SPDX-License-Identifier: BSD-3-Clause
"""XML as a plain tree, by expat, with the bytes that each element has in the file."""

from xml.parsers import expat

from strict import Invalid, Unknown


class Element:
    def __init__(self, name, attributes, begin):
        self.name, self.attributes, self.begin, self.end = name, attributes, begin, None
        self.children, self.text = [], ""

    def all(self, *names):
        return [child for child in self.children if child.name in names]

    def one(self, name):
        """The only child of that name, or None; Invalid if there are several that differ."""
        found = self.all(name)
        if any(other.content() != found[0].content() for other in found[1:]):
            raise Invalid(f"<{self.name}> has several <{name}>")
        return found[0] if found else None

    def content(self):
        return self.name, self.text, self.attributes, [child.content() for child in self.children]

    def need(self, name):
        found = self.one(name)
        if found is None:
            raise Invalid(f"<{self.name}> has no <{name}>")
        return found

    def get(self, attribute):
        if attribute not in self.attributes:
            raise Invalid(f"<{self.name}> has no {attribute}")
        return self.attributes[attribute]

    def walk(self):
        pending = [self]
        while pending:
            element = pending.pop()
            yield element
            pending += reversed(element.children)


def parse(data):
    open_elements, roots = [], []
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def start(name, attributes):
        element = Element(name, attributes, parser.CurrentByteIndex)
        if open_elements:
            open_elements[-1].children.append(element)
        else:
            roots.append(element)
        open_elements.append(element)
        if len(open_elements) > 1000:
            raise Unknown("elements nested a thousand deep")

    def end(_):
        tail = data[parser.CurrentByteIndex:]
        open_elements.pop().end = parser.CurrentByteIndex + (tail.index(b">") + 1 if b">" in tail else 0)

    def text(piece):
        open_elements[-1].text += piece

    parser.StartElementHandler, parser.EndElementHandler, parser.CharacterDataHandler = start, end, text
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise Invalid(f"no well-formed XML: {error}") from error
    return roots[0]
