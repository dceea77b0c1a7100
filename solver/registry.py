"""Laws of one kind by FEBio's type names; a file is read when its type is first asked for."""

from __future__ import annotations

from importlib import import_module
from typing import Generic, TypeVar

L = TypeVar("L")


class Registry(Generic[L]):
    """Type names -> files of the package ``package``; each file ends by registering its class."""

    def __init__(self, package: str, types: dict[str, str]) -> None:
        self.package, self.types = package, types
        self._classes: dict[str, type[L]] = {}

    def register(self, cls: type[L], *febio_types: str) -> None:
        """Make a class known by FEBio's type names; the last line of a law's file. Raises LookupError for a name that
        the table of types lacks, or has in another file."""
        here = cls.__module__.removeprefix(f"{self.package}.")
        for name in febio_types:
            if self.types.get(name) != here:
                listed = self.types.get(name)
                raise LookupError(f"{name!r} of {self.package} is in {listed}, says its table, not in {here}")
            self._classes[name] = cls

    def known(self, febio_type: str) -> bool:
        return febio_type in self.types

    def load(self, febio_type: str) -> type[L]:
        """The class of a type; KeyError where there is none."""
        import_module(f"{self.package}.{self.types[febio_type]}")
        return self._classes[febio_type]
