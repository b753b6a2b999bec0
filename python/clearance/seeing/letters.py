# SPDX-License-Identifier: BSD-3-Clause
"""Letters of 5 x 8 dots, for pictures on a machine that has no fonts."""

import numpy as np

# Rows from the top; each is 5 dots in binary, written in base 32 ("v" is all five). The last row hangs below the line.
_DIGITS = "0123456789abcdefghijklmnopqrstuv"
_ROWS = {
    " ": "00000000",
    "!": "44444040",
    '"': "aa000000",
    "#": "aavava00",
    "%": "op248j30",
    "&": "8kk8lid0",
    "'": "44000000",
    "(": "24888420",
    ")": "84222480",
    "*": "04lel400",
    "+": "044v4400",
    ",": "00000448",
    "-": "000v0000",
    ".": "00000cc0",
    "/": "01248g00",
    "0": "ehjlphe0",
    "1": "4c4444e0",
    "2": "eh1248v0",
    "3": "v2421he0",
    "4": "26aiv220",
    "5": "vgu11he0",
    "6": "68guhhe0",
    "7": "v1248880",
    "8": "ehhehhe0",
    "9": "ehhf12c0",
    ":": "0cc0cc00",
    ";": "0cc0c480",
    "<": "248g8420",
    "=": "00v0v000",
    ">": "84212480",
    "?": "eh124040",
    "@": "eh1dlle0",
    "A": "ehhhvhh0",
    "B": "uhhuhhu0",
    "C": "ehggghe0",
    "D": "sihhhis0",
    "E": "vgguggv0",
    "F": "vgguggg0",
    "G": "ehgnhhf0",
    "H": "hhhvhhh0",
    "I": "e44444e0",
    "J": "72222ic0",
    "K": "hikokih0",
    "L": "ggggggv0",
    "M": "hrllhhh0",
    "N": "hhpljhh0",
    "O": "ehhhhhe0",
    "P": "uhhuggg0",
    "Q": "ehhhlid0",
    "R": "uhhukih0",
    "S": "fgge11u0",
    "T": "v4444440",
    "U": "hhhhhhe0",
    "V": "hhhhha40",
    "W": "hhhllla0",
    "X": "hha4ahh0",
    "Y": "hhha4440",
    "Z": "v1248gv0",
    "[": "e88888e0",
    "]": "e22222e0",
    "^": "4ah00000",
    "_": "000000v0",
    "a": "00e1fhf0",
    "b": "ggmphhu0",
    "c": "00egghe0",
    "d": "11djhhf0",
    "e": "00ehvge0",
    "f": "698s8880",
    "g": "00fhhf1e",
    "h": "ggmphhh0",
    "i": "40c444e0",
    "j": "2062222c",
    "k": "ggikoki0",
    "l": "c44444e0",
    "m": "00qlllh0",
    "n": "00mphhh0",
    "o": "00ehhhe0",
    "p": "00uhhugg",
    "q": "00fhhf11",
    "r": "00mpggg0",
    "s": "00fge1u0",
    "t": "88s88960",
    "u": "00hhhjd0",
    "v": "00hhha40",
    "w": "00hllla0",
    "x": "00ha4ah0",
    "y": "00hhhf1e",
    "z": "00v248v0",
    "|": "44444440",
    "~": "008l2000",
}


def _dots(letter):
    rows = _ROWS.get(letter, "vhhhhhv0")  # a box for what is not known
    return np.array([[_DIGITS.index(row) >> (4 - k) & 1 for k in range(5)] for row in rows], float)


def mask(words, scale=2):
    """What of a rectangle is covered by the words: float (8 * scale, 6 * scale * letters)."""
    if not words:
        return np.zeros((8 * scale, 0))
    return np.kron(
        np.concatenate([np.pad(_dots(letter), ((0, 0), (0, 1))) for letter in words], axis=1), np.ones((scale, scale))
    )
