"""Damaged inputs: single bytes, runs, tags, numbers, lines, sections, drawn at random."""

import random
import re

_TAG = re.compile(rb"<[^<>]{1,60}>")
_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:e-?\d+)?")
_NUMBERS = (b"nan", b"inf", b"-1", b"0", b"1e400", b"99999999999999999999", b"1e-320", b"0x10", b"1,2", b"", b"1e5",
            b"--1", b"2147483648", b"1.5.2", b"\xc3\xa9")
_WORDS = (b"<!DOCTYPE x>", b"<![CDATA[", b"]]>", b"<!--", b"-->", b"&amp;", b"&x;", b"<a/>", b"</", b"<", b">", b'"',
          b"\x00", b"<Include>../x.feb</Include>", b'from="x.feb"', b"@surface:top", b'type="math"', b'lc="9"')


def mutate(data: bytes, rng: random.Random) -> bytes:
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        data = rng.choice(_WAYS)(data, rng)
    return data


def _span(data: bytes, rng: random.Random, most: int = 60) -> tuple[int, int]:
    a = rng.randrange(max(len(data), 1))
    return a, min(len(data), a + rng.randrange(1, most))


def _flip(data: bytes, rng: random.Random) -> bytes:
    a = rng.randrange(max(len(data), 1))
    return data[:a] + bytes([rng.randrange(256)]) + data[a + 1:]


def _cut(data: bytes, rng: random.Random) -> bytes:
    a, b = _span(data, rng, 400)
    return data[:a] + data[b:]


def _double(data: bytes, rng: random.Random) -> bytes:
    a, b = _span(data, rng, 400)
    return data[:b] + data[a:b] + data[b:]


def _truncate(data: bytes, rng: random.Random) -> bytes:
    return data[:rng.randrange(max(len(data), 1))]


def _insert(data: bytes, rng: random.Random) -> bytes:
    a, _ = _span(data, rng)
    return data[:a] + rng.choice(_WORDS) + data[a:]


def _number(data: bytes, rng: random.Random) -> bytes:
    found = list(_NUMBER.finditer(data))
    if not found:
        return data
    m = rng.choice(found)
    return data[:m.start()] + rng.choice(_NUMBERS) + data[m.end():]


def _tag(data: bytes, rng: random.Random) -> bytes:
    found = list(_TAG.finditer(data))
    if len(found) < 2:
        return data
    a, b = rng.choice(found), rng.choice(found)
    return data[:a.start()] + b.group() + data[a.end():]


def _lines(data: bytes, rng: random.Random) -> bytes:
    rows = data.split(b"\n")
    i, j = rng.randrange(len(rows)), rng.randrange(len(rows))
    rows[i], rows[j] = rows[j], rows[i]
    return b"\n".join(rows)


def _attribute(data: bytes, rng: random.Random) -> bytes:
    found = list(re.finditer(rb'"[^"<>]*"', data))
    if len(found) < 2:
        return data
    a, b = rng.choice(found), rng.choice(found)
    return data[:a.start()] + b.group() + data[a.end():]


_WAYS = (_flip, _cut, _double, _truncate, _insert, _number, _number, _tag, _lines, _attribute)
