"""What contacts say of their surfaces: means over facets."""

from __future__ import annotations

from .base import Face, Floats, Give, register


def facets(what: str) -> Give:
    """Facet means of the "gap", "pressure" or "traction" of the first contact that has a surface (facet, ...)."""

    def give(face: Face) -> Floats | None:
        system = face.view.run.system
        for contact in system.contacts if system is not None else ():
            values = contact.on_facets(what, face.view.state)
            for name, v in zip(contact.names, values or (), strict=False):
                if name == face.name:
                    return v  # type: ignore[no-any-return]
        return None

    return give


register("contact gap", facets("gap"))
register("contact pressure", facets("pressure"))
register("contact traction", facets("traction"))
