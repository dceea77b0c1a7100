"""Where a scene is looked at from, and what the picture says of directions and lengths."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from febkit.model import InputError

Floats = NDArray[np.float64]
# where each plane is looked at from, and which way is up: x-z and y-z upright, x-y as on paper
VIEWS = {"x": ((1, 0, 0), (0, 0, 1)), "y": ((0, -1, 0), (0, 0, 1)), "z": ((0, 0, 1), (0, 1, 0))}
_AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """Looks along -``towards`` with ``up`` upwards, without perspective; ``half`` the height shown, from the middle."""

    towards: Floats
    up: Floats
    zoom: float = 1.0
    centre: Floats | None = None
    half: tuple[float, float] = (1.0, 1.0)  # half the width and height of what is shown

    @classmethod
    def of(cls, text: Camera | str | None, cut: str | None = None, zoom: float = 1.0) -> Camera:
        """From "iso", "x" ... "-z", "azimuth,elevation"; None looks at the cut from a little aside."""
        if isinstance(text, Camera):
            return replace(text, zoom=zoom * text.zoom)
        if not 0 < zoom < 1e6:
            raise InputError(f"a zoom is a number above 0, not {zoom}")
        if text is None:
            normal, up = (np.array(v, dtype=float) for v in VIEWS[cut or "y"])
            aside = (0.25, 0.2) if cut else (0.7, 0.5)
            return cls(_unit(normal + aside[0] * np.cross(up, normal) + aside[1] * up), up, zoom)
        name = text.strip().lower()
        if name == "iso":
            return cls(_unit(np.array([1.0, -1.0, 0.8])), np.array([0.0, 0.0, 1.0]), zoom)
        if name.lstrip("+-") in _AXES:
            axis = name.lstrip("+-")
            towards = np.array(_AXES[axis], dtype=float) * (-1 if name[0] == "-" else 1)
            return cls(towards, np.array([0.0, 1.0, 0.0] if axis == "z" else [0.0, 0.0, 1.0]), zoom)
        try:
            azimuth, elevation = (np.radians(float(v)) for v in name.replace(",", " ").split())
        except ValueError:
            raise InputError(f'{text!r} is no camera: "iso", "x", "-y", or azimuth and elevation, "30,20"') from None
        flat = np.cos(elevation)
        towards = np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])
        steep = abs(flat) < 1e-3
        return cls(towards, np.array([0.0, 1.0, 0.0] if steep else [0.0, 0.0, 1.0]), zoom)

    @property
    def frame(self) -> tuple[Floats, Floats]:
        """Right and up of the picture, of length one."""
        right = _unit(np.cross(self.up, self.towards))
        return right, np.cross(self.towards, right)

    def onto(self, *meshes: Any) -> Camera:
        """Aimed at all that these meshes hold."""
        points = np.concatenate([np.asarray(m.points, dtype=float) for m in meshes])
        right, up = self.frame
        flat = np.stack([points @ right, points @ up, points @ self.towards], axis=1)
        low, high = flat.min(axis=0), flat.max(axis=0)
        middle = 0.5 * (low + high)
        centre = middle[0] * right + middle[1] * up + middle[2] * self.towards
        reach = max(float((high - low).max()), 1e-30)
        half = np.maximum(0.5 * (high - low)[:2], 1e-3 * reach) * 1.06 / self.zoom
        return replace(self, centre=centre, half=(float(half[0]), float(half[1])))

    def scale(self, width: int, height: int) -> float:
        """Half the height of the picture in the model's lengths."""
        room = 0.86  # below it are axes and ruler
        return max(self.half[1] / room, self.half[0] * height / width)

    def aim(self, plotter: Any) -> None:
        """Set a plotter's camera."""
        assert self.centre is not None
        width, height = plotter.window_size
        scale = self.scale(width, height)
        reach = 4 * max(*self.half, scale)
        _, up = self.frame
        centre = self.centre - 0.12 * scale * up
        plotter.camera_position = [tuple(centre + reach * self.towards), tuple(centre), tuple(up)]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = scale
        plotter.reset_camera_clipping_range()

    def triad(self, ax: Any, shape: tuple[int, ...]) -> None:
        """Arrows of the axes in the lower left corner of an image of this shape."""
        right, up = self.frame
        arm = 0.075 * min(shape[0], shape[1])
        x0, y0 = 1.7 * arm, shape[0] - 1.6 * arm
        for name, axis in _AXES.items():
            a, b = float(np.dot(axis, right)), float(np.dot(axis, up))
            if np.hypot(a, b) < 0.05:
                continue  # it points at the viewer
            look = dict(arrowstyle="-|>", color="black", lw=1.0, shrinkA=0, shrinkB=0, mutation_scale=8)
            ax.annotate("", (x0 + arm * a, y0 - arm * b), (x0, y0), arrowprops=look)
            reach = 1.3 + 0.15 / np.hypot(a, b)
            ax.text(x0 + reach * arm * a, y0 - reach * arm * b, name, ha="center", va="center", fontsize=8)

    def ruler(self, ax: Any, shape: tuple[int, ...], unit: str) -> None:
        """A bar of a round length at the foot of the image."""
        per_pixel = 2 * self.scale(shape[1], shape[0]) / shape[0]
        most = 0.25 * shape[1] * per_pixel
        ten = 10 ** np.floor(np.log10(most))
        length = max(m * ten for m in (1, 2, 5) if m * ten <= most)
        n = length / per_pixel
        x1, y = 0.97 * shape[1], 0.955 * shape[0]
        ax.plot([x1 - n, x1], [y, y], color="black", lw=2, solid_capstyle="butt")
        ax.text(x1 - n / 2, y - 0.012 * shape[0], f"{length:g} {unit}".rstrip(), ha="center", va="bottom", fontsize=8)


def _unit(v: Floats) -> Floats:
    return np.asarray(v / np.linalg.norm(v))
