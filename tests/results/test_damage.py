"""Plotfiles that are cut, damaged or made to hurt: what is whole is read, what is not is named, nothing is inflated
that is not asked for."""

from __future__ import annotations

import gc
import struct
import subprocess
import sys
import warnings
import zlib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from febkit import results
from febkit.model import InputError
from febkit.results.xplt import container
from febkit.results.xplt.inflate import Inflated
from febkit.results.xplt.reader import PlotFile
from helpers import descriptors, forked

FEBKIT = Path(sys.executable).parent / "febkit"
STATE = 0x02000000
COUNTED = """
import resource, subprocess, sys
done = subprocess.run(sys.argv[1:], capture_output=True, text=True, timeout=20)
print(done.returncode, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
print(done.stdout + done.stderr)
"""


def febkit(*args: object) -> tuple[int, str]:
    """Exit code, and all that the command says."""
    done = forked.febkit(*args, folder=Path.cwd())
    return done.returncode, done.stdout + done.stderr


def measured(*args: object) -> tuple[int, int, str]:
    """Exit code, peak memory in MB and words of the installed command, in a process that has done nothing else."""
    command = [sys.executable, "-c", COUNTED, str(FEBKIT), *map(str, args)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    first, _, said = done.stdout.partition("\n")
    code, peak = map(int, first.split())
    return code, peak // 1000, said


def bomb(head: bytes, size: int, tag: int = 0x02040000) -> bytes:
    """A packed state of ``size`` bytes, nearly all of them zeros in one block."""
    time = struct.pack("<IIIIf", 0x02010000, 12, 0x02010002, 4, 0.0)
    start = struct.pack("<II", STATE, size - 8) + time
    start += struct.pack("<II", tag, size - 8 - len(time) - 8)
    z = zlib.compressobj(1)
    out, left = [head, z.compress(start)], size - len(start)
    while left:
        n = min(left, 1 << 24)
        out.append(z.compress(bytes(n)))
        left -= n
    return b"".join([*out, z.flush()])


def test_a_state_that_claims_more_than_the_mesh_can_fill_is_refused_unread(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "bomb.xplt"
    path.write_bytes(bomb(make_modern(states=0), 600_000_000))
    for verb in (["info", path], ["convert", path, tmp_path / "out.nc"]):
        code, peak, said = measured(*verb)
        assert "unfolds to 599999992 bytes" in said and "Traceback" not in said, said
        assert code and peak < 200, (code, peak)
    assert not (tmp_path / "out.nc").exists()


def test_a_large_packed_state_is_read_piece_by_piece(tmp_path: Path, make_modern) -> None:
    """60 MB within bounds that a mesh of twelve nodes could explain: opened without holding them."""
    path = tmp_path / "large.xplt"
    path.write_bytes(bomb(make_modern(states=0), 60_000_000, tag=0x02990000))
    code = f"""
import resource, febkit.results as r, febkit.results.xplt.container as c
import febkit.results.dataset, febkit.results.xplt.reader
c.KEPT = 1 << 20
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
ds = r.open({str(path)!r})
assert ds.sizes["time"] == 1 and ds["displacement"].isnull().all()
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 30_000, done.stdout  # kB


@pytest.mark.parametrize("packed", ["block", "body"])
def test_states_that_are_not_held_give_what_held_ones_give(tmp_path: Path, make_modern, monkeypatch, packed) -> None:
    plain, path = tmp_path / "plain.xplt", tmp_path / "packed.xplt"
    plain.write_bytes(make_modern())
    path.write_bytes(make_modern(packed=packed))
    monkeypatch.setattr(container, "KEPT", 100)
    with PlotFile(path) as f:
        assert f.payload(0).streamed
    xr.testing.assert_identical(results.open(plain).load(), results.open(path).load())
    lazy = results.open(path, chunks={"time": 1})
    xr.testing.assert_identical(results.open(plain).load(), lazy.compute(scheduler="threads"))


def test_random_content_that_is_not_held(tmp_path: Path, random_plot, monkeypatch) -> None:
    random_plot(tmp_path / "a.xplt", 5, 3, compress=True)
    whole = results.open(tmp_path / "a.xplt", apart=True).load()
    monkeypatch.setattr(container, "KEPT", 1000)
    xr.testing.assert_identical(whole, results.open(tmp_path / "a.xplt", apart=True).load())


def test_opening_inflates_the_first_state_alone(tmp_path: Path, make_modern, monkeypatch) -> None:
    """Times and statuses stand among a packed state's first bytes."""
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern(packed="body", states=5))
    touched: list[int] = []
    inflate = container.Container._inflate
    monkeypatch.setattr(container.Container, "_inflate",
                        lambda c, b: touched.append(c.blocks.index(b)) or inflate(c, b))  # fmt: skip
    ds = results.open(path)
    assert ds["time"].size == 5 and (ds["state_status"] == 0).all()
    assert set(touched) == {2}  # behind the root and the mesh
    ds["stress"].isel(time=3).load()
    assert set(touched) == {2, 5}


@pytest.mark.parametrize("n", [0, 1, 3_000_000])
def test_streams_by_any_slices(tmp_path: Path, n: int) -> None:
    from febkit.model import Where

    rng = np.random.default_rng(3)
    data = rng.integers(0, 4, n, dtype=np.uint8).tobytes()
    raw = b"before" + zlib.compress(data) + b"after"
    s = Inflated(raw, 6, len(raw), Where("x"))
    assert s.end() == (n, len(raw) - 5)
    assert s.whole(n) == data and s.whole(n - 1) is None
    for _ in range(20):
        a, b = sorted(int(x) for x in rng.integers(0, n + 1, 2))
        assert s[a:b] == data[a:b]
    with pytest.raises(InputError, match="cut short"):
        s[n : n + 1]
    short = Inflated(raw[: len(raw) // 2], 6, len(raw) // 2, Where("x"))
    assert short.end() is None
    with pytest.raises(InputError, match="cut short"):
        short.whole(n)


def test_zeros_behind_the_last_state_are_left_out_and_said(tmp_path: Path, make_modern) -> None:
    """As a file system leaves a file that was not written to the end when the power went."""
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern() + bytes(4096))
    with pytest.warns(UserWarning, match="last 4096 bytes are no complete state"):
        assert results.open(path).sizes["time"] == 3
    with pytest.warns(UserWarning, match="a.xplt"):
        results.open_all(path)
    code, said = febkit("info", path)
    assert code == 0 and "4096 bytes of a state that is not complete" in said
    code, said = febkit("convert", path, tmp_path / "b.nc")
    assert code == 0 and "last 4096 bytes" in said
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        path.write_bytes(make_modern())
        results.open(path)


def test_a_state_whose_size_is_damaged_is_no_end_of_the_file(tmp_path: Path, make_modern) -> None:
    raw = bytearray(make_modern())
    size = (len(raw) - len(make_modern(states=0))) // 3
    at = len(raw) - 2 * size
    raw[at + 4 : at + 8] = struct.pack("<I", 0x7FFFFFFF)
    path = tmp_path / "a.xplt"
    path.write_bytes(raw)
    with pytest.raises(InputError, match=f"byte {at}: .*past the end .* another follows at byte {at + size}"):
        results.open(path)


def test_states_without_content(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "a.xplt"
    for n in (1, 2, 5):
        path.write_bytes(make_modern() + struct.pack("<II", STATE, 0) * n)
        code, said = febkit("info", path)
        assert code and "a state has no time" in said and "Traceback" not in said


def test_no_flags_of_elements_are_copied_as_none(tmp_path: Path, make_modern) -> None:
    """FEBio lists none for some meshes of shells."""
    a, b = tmp_path / "a.xplt", tmp_path / "b.xplt"
    a.write_bytes(make_modern(flags=()))
    assert (results.open(a)["element_state"] == 1).all()
    code, said = febkit("convert", a, b)
    assert code == 0, said
    with PlotFile(b) as f:
        assert f.element_state(1).size == 0  # type: ignore[union-attr]


@pytest.mark.parametrize("order", ["<", ">"])
def test_flags_of_another_number_of_elements_are_named(tmp_path: Path, make_modern, order: str) -> None:
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern(order))
    assert results.open(path)["element_state"].values.tolist() == [[1, 1]] * 3
    path.write_bytes(make_modern(order, flags=(1, 1, 1)))
    with pytest.raises(InputError, match="flags of 3 elements where the mesh has 2"):
        results.open(path)["element_state"].load()
    code, said = febkit("convert", path, tmp_path / "b.xplt")
    assert code and "flags of 3 elements" in said and "Traceback" not in said


def test_names_are_64_characters_at_most(tmp_path: Path, blocks, make_modern) -> None:
    """A name whose block is longer is damage; NetCDF refuses to hold it."""
    path = tmp_path / "a.xplt"
    path.write_bytes(make_modern(stress=blocks.block(0x01020004, b"x" * 512)))
    assert "x" * 64 in results.open(path)
    code, said = febkit("convert", path, tmp_path / "a.nc")
    assert code == 0, said


@descriptors.listed
def test_no_descriptor_stays_open(tmp_path: Path, make_modern) -> None:
    good, bad, many = (tmp_path / f"{n}.xplt" for n in ("good", "bad", "many"))
    raw = make_modern(states=2)
    good.write_bytes(raw)
    bad.write_bytes(raw.replace(struct.pack("<III", 0x01042102, 4, 0), struct.pack("<III", 0x01042102, 4, 77), 1))
    start = raw.index(struct.pack("<I", 0x01040000), 100)
    end = start + 8 + struct.unpack_from("<I", raw, start + 4)[0]
    many.write_bytes(raw + raw[start:end] + raw[end:])
    gc.disable()
    try:
        kept: list[Exception] = []  # with the frames that opened the file
        for _ in range(5):
            results.open(good).close()
            for path, read in ((bad, results.open), (bad, results.open_all), (many, results.open)):
                with pytest.raises(InputError) as e:
                    read(path)
                kept.append(e.value)
            for ds in results.open_all(many):
                ds.close()
        assert descriptors.held(tmp_path) == []
    finally:
        gc.enable()


def test_the_datasets_of_several_meshes_share_a_file(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "a.xplt"
    raw = make_modern(states=2)
    start = raw.index(struct.pack("<I", 0x01040000), 100)
    end = start + 8 + struct.unpack_from("<I", raw, start + 4)[0]
    path.write_bytes(raw + raw[start:end] + raw[end:])
    first, second = results.open_all(path)
    first.close()
    first.close()
    np.testing.assert_array_equal(second["displacement"][0, 0], [0, 1, 2])
    second.close()


def test_what_a_file_says_twice_is_refused(tmp_path: Path, make_modern) -> None:
    """Which of the two counts nobody can know."""
    from helpers.mutate_plot import parse

    raw = make_modern()
    path = tmp_path / "a.xplt"

    def spoiled(tag: int, inside: int) -> bytes:
        top = parse(raw, "<")
        for n in (n for b in top if b.tag == inside for n in b.walk()):
            for k, child in enumerate(n.children):
                if child.tag == tag:
                    n.children.insert(k, child)
                    return raw[:4] + b"".join(b.bytes("<") for b in top)
        raise AssertionError

    for tag, inside, said in ((0x02010002, STATE, "two times"), (0x02020001, STATE, "data of region 0 twice"),
                              (0x01041000, 0x01040000, "section 0x01041000 twice")):  # fmt: skip
        path.write_bytes(spoiled(tag, inside))
        with pytest.raises(InputError, match=said):
            results.open(path).load()


def test_times_are_numbers(tmp_path: Path, make_modern) -> None:
    path = tmp_path / "a.xplt"
    old = struct.pack("<IIf", 0x02010002, 4, 0.1)
    for packed in ("", "block"):
        top = make_modern().replace(old, struct.pack("<IIf", 0x02010002, 4, np.nan))
        if packed:
            from helpers.mutate_plot import parse

            blocks = parse(top, "<")
            for b in blocks:
                b.packed = packed if b.tag == STATE else ""
            top = top[:4] + b"".join(b.bytes("<") for b in blocks)
        path.write_bytes(top)
        with pytest.raises(InputError, match="the time of state 2 is nan"):
            results.open(path)


@pytest.mark.parametrize(("tag", "what"), [(0x01043103, "surface 'front'"), (0x01044104, "set 'fix'")])
def test_lists_are_as_long_as_their_headers_say(tmp_path: Path, make_modern, tag: int, what: str) -> None:
    path = tmp_path / "a.xplt"
    old = struct.pack("<III", tag, 4, 2)
    path.write_bytes(make_modern().replace(old, struct.pack("<III", tag, 4, 3)))
    with pytest.raises(InputError, match=f"{what}: it lists 2 where its header counts 3"):
        results.open(path)
