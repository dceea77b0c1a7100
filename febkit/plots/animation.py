"""Scenes over time: a GIF by Pillow, an MP4 where imageio-ffmpeg is."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from febkit.files import written
from febkit.model import InputError

from . import canvas
from .camera import Camera
from .quantity import clock
from .render import _page, limits_of, seen, shot

if TYPE_CHECKING:
    import xarray as xr

Pixels = NDArray[np.uint8]


def movie(
    ds: xr.Dataset,
    path: str | os.PathLike[str],
    variable: str = "displacement:magnitude",
    times: Sequence[float] | None = None,
    *,
    fps: float = 10.0,
    limits: tuple[float, float] | None = None,
    size: tuple[int, int] = (800, 600),
    title: str = "",
    camera: Camera | str | None = None,
    zoom: float = 1.0,
    progress: Callable[[int, int], None] | None = None,
    **shown: Any,
) -> None:
    """Write the states of a result as an animation, .gif or .mp4, with one camera and one colour scale throughout.

    times   those shown, all states by default; ``fps`` of them a second
    Other options are those of :func:`.render.scene`. Raises InputError where what writes it is missing.
    """
    path = Path(path)
    write = {".gif": _gif, ".mp4": _mp4}.get(path.suffix.lower())
    if write is None:
        raise InputError(f"{path}: an animation ends in .gif or .mp4")
    if not 0 < fps <= 100:
        raise InputError(f"{fps:g} pictures a second cannot be shown: take 1 to 60")
    if path.suffix.lower() == ".mp4":
        _ffmpeg()
    s = shot(ds, variable, **shown)
    states = _states(ds, times)
    made = [s.at(t) for t in states]
    ends, view = _common(made, limits, Camera.of(camera, s.plane.axis if s.plane else None, zoom))

    def frames() -> Iterator[Pixels]:
        for k, (t, (shell, face)) in enumerate(zip(states, made)):
            with canvas.style():
                words = "\n".join(w for w in (title, clock(ds, t)) if w)
                figure = _page(s, shell, face, ends, view, size, words)
                figure.canvas.draw()
            if progress:
                progress(k + 1, len(states))
            yield np.array(figure.canvas.buffer_rgba())[..., :3]

    write(path, frames(), fps)


def _states(ds: xr.Dataset, times: Sequence[float] | None) -> list[int]:
    from .quantity import time_index

    if times is None:
        found = list(range(ds.sizes["time"]))
    else:
        found = [time_index(ds, float(t)) for t in times]
    if not found:
        raise InputError("the result holds no state")
    return found


def _common(
    made: Sequence[tuple[Any, Any]], limits: tuple[float, float] | None, camera: Camera
) -> tuple[tuple[float, float], Camera]:
    """Ends of the colours, and the camera that has all states in view."""
    values = []
    for shell, face in made:
        v = seen(shell, face)
        v = v[np.isfinite(v)]
        if len(v):
            values.append(np.quantile(v, np.linspace(0, 1, 101)))
    if not values:
        raise InputError("the variable has no value on what is shown")
    return limits or limits_of(np.concatenate(values)), camera.onto(*(shell for shell, _ in made))


def _gif(path: Path, frames: Iterator[Pixels], fps: float) -> None:
    from PIL import Image

    pictures = [Image.fromarray(f).quantize(256, dither=Image.Dither.NONE) for f in frames]
    with written(path) as part:
        pictures[0].save(part, format="GIF", save_all=True, append_images=pictures[1:], duration=1000 / fps, loop=0)


def _ffmpeg() -> Any:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise InputError('an .mp4 needs imageio-ffmpeg: pip install "febkit[movies]", or write a .gif') from None
    return imageio_ffmpeg


def _mp4(path: Path, frames: Iterator[Pixels], fps: float) -> None:
    first = next(frames)
    height, width = (n // 2 * 2 for n in first.shape[:2])  # what H.264 takes
    with written(path) as part:
        out = _ffmpeg().write_frames(
            str(part), (width, height), fps=fps, codec="libx264", quality=8, macro_block_size=1,
            output_params=["-f", "mp4"],
        )  # fmt: skip
        out.send(None)
        out.send(np.ascontiguousarray(first[:height, :width]))
        for f in frames:
            out.send(np.ascontiguousarray(f[:height, :width]))
        out.close()
