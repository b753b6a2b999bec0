# SPDX-License-Identifier: BSD-3-Clause
"""What the strict readers of this folder share. They follow the formats' specifications and docs/io.md, never the library's
code: what they make of a damaged file decides which answers of the command are right."""

import math
import re

_decimal = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\Z", re.ASCII)
_not_finite = re.compile(r"[+-]?(inf|infinity|nan|nan\([a-z0-9_]*\))\Z", re.ASCII | re.IGNORECASE)
_whole = re.compile(r"[+-]?\d+\Z", re.ASCII)


class Invalid(Exception):
    """The file is none of its format: it must be refused, or be answered like the undamaged one."""


class Unknown(Exception):
    """These readers cannot say what the file means; only the manners of the answer are judged."""


def demand(holds, why):
    if not holds:
        raise Invalid(why)


def number(word, finite=True):
    """The finite number that a word spells; with finite=False also inf and nan."""
    if _decimal.match(word):
        value = float(word)
        demand(not finite or math.isfinite(value), f"{word[:40]!r} is beyond any double")
        return value
    demand(not finite and _not_finite.match(word), f"{word[:40]!r} is not a number")
    return math.nan if "n" in word.lower().replace("inf", "").replace("ity", "") else float(word.replace("+", ""))


def numbers(text, count):
    found = [number(word) for word in text.split()]
    demand(len(found) == count, f"{len(found)} numbers, not {count}")
    return found


def whole(word, low=0, high=2**32 - 1):
    demand(_whole.match(word) and low <= int(word[:30]) <= high, f"{word[:40]!r} is no whole number from {low} to {high}")
    return int(word)


def without_mark(data):
    """Without the byte order mark that some editors put first."""
    return data.removeprefix(b"\xef\xbb\xbf")


def text_of(data):
    """Bytes as text, one character a byte, without the mark."""
    return without_mark(data).decode("latin-1")


def lines_of(data):
    """Lines by any ending: \\n, \\r\\n or \\r."""
    return re.split(r"\r\n|\n|\r", text_of(data))


def words_of(line, separators=" \t\v\f"):
    return [word for word in re.split(f"[{re.escape(separators)}]+", line) if word]


def uncommented(line):
    """Without the comment, which begins with a # at the start of a word: "1.#QNAN" is a word, and no number."""
    return re.split(r"(?:^|(?<=[ \t\v\f,;]))#", line, maxsplit=1)[0]
