"""``import febkit`` has meshio know .feb and .xplt, whichever of the two is imported first.

meshio has no entry points. Where it is not loaded yet, a finder before Python's own waits for meshio, and nothing
else, to be looked for: febkit does not import it. What reads files is loaded when a file is read.
"""

from __future__ import annotations

import sys

TYPE_CHECKING = False  # typing's own takes longer to import than all else here
if TYPE_CHECKING:
    from importlib.machinery import ModuleSpec
    from types import ModuleType
    from typing import Any

NAME = "FebkitInMeshio"  # of the finder


def watch() -> None:
    """Register with meshio now where it is loaded, else when it will be."""
    meshio = sys.modules.get("meshio")
    if meshio is not None:
        if hasattr(meshio, "register_format"):  # else it is being imported just now
            register(meshio)
    elif not any(getattr(f, "__name__", "") == NAME for f in sys.meta_path):
        sys.meta_path.insert(0, FebkitInMeshio)


class FebkitInMeshio:
    """Finds what the other finders find."""

    @staticmethod
    def find_spec(name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        return spec(name, path, target) if name == "meshio" else None


def spec(name: str, path: Any, target: Any) -> ModuleSpec | None:
    """meshio as the other finders find it, with :func:`register` after it is loaded."""
    others = [f for f in sys.meta_path if getattr(f, "__name__", "") != NAME and hasattr(f, "find_spec")]
    found = next((s for f in others if (s := f.find_spec(name, path, target)) is not None), None)
    loader = None if found is None else found.loader
    if loader is None or not hasattr(loader, "exec_module"):
        return found
    load = loader.exec_module

    def exec_module(module: ModuleType) -> None:
        load(module)
        try:
            register(module)
        except Exception as e:  # whatever changes in meshio, importing it must not fail for febkit's sake
            import warnings

            warnings.warn(f"febkit could not register .feb and .xplt with meshio: {e!r}", stacklevel=2)

    try:
        loader.exec_module = exec_module  # type: ignore[method-assign]
    except AttributeError:  # a loader that takes no attributes: meshio stays as it is
        return found
    return found


def register(meshio: Any) -> None:
    """Make meshio know .feb and .xplt."""
    if ".feb" not in meshio.extension_to_filetypes:
        meshio.register_format("febio", [".feb"], _read_feb, {"febio": _write_feb})
    if ".xplt" not in meshio.extension_to_filetypes:
        meshio.register_format("febio-plot", [".xplt"], _read_xplt, {})


def _read_feb(path: Any) -> Any:
    from .meshio_format import read_feb

    return read_feb(path)


def _read_xplt(path: Any) -> Any:
    from .meshio_format import read_xplt

    return read_xplt(path)


def _write_feb(path: Any, mesh: Any, **options: Any) -> None:
    from .meshio_format import write_feb

    write_feb(path, mesh, **options)
