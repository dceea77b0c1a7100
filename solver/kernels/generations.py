"""Deformation of bonds as seen from the states in which they were born."""

from __future__ import annotations

from ..jit import kernel


@kernel
def since_birth(F, J, gen, count, used, at_J, at_U, Fg, Jg, Jb):
    """F U^-1 and J / Jb of point i for each of the b generations ``used``: Fg (n b, 3, 3), Jg (n b,), Jb (n, b).

    Generation g was born in the state (U, Jb) kept with generation g - 1 in ``gen`` (n, capacity, columns), U
    symmetric in the columns from ``at_U`` (xx yy zz xy yz xz); the first, and those beyond ``count``, in the
    reference state.
    """
    b = len(used)
    for i in range(len(J)):
        f = F[i]
        for k in range(b):
            g, m = used[k], i * b + k
            if g == 0 or g >= count[i]:
                Jb[i, k] = 1.0
                Jg[m] = J[i]
                for r in range(3):
                    for c in range(3):
                        Fg[m, r, c] = f[r, c]
                continue
            q = gen[i, g - 1]
            x, y, z, xy, yz, xz = (
                q[at_U], q[at_U + 1], q[at_U + 2], q[at_U + 3], q[at_U + 4], q[at_U + 5]
            )  # fmt: skip
            c0, c1, c2 = y * z - yz * yz, xz * yz - xy * z, xy * yz - xz * y
            d = 1.0 / (x * c0 + xy * c1 + xz * c2)
            i00, i01, i02 = c0 * d, c1 * d, c2 * d
            i11, i12, i22 = (x * z - xz * xz) * d, (xy * xz - x * yz) * d, (x * y - xy * xy) * d
            for r in range(3):
                u, v, w = f[r, 0], f[r, 1], f[r, 2]
                Fg[m, r, 0] = u * i00 + v * i01 + w * i02
                Fg[m, r, 1] = u * i01 + v * i11 + w * i12
                Fg[m, r, 2] = u * i02 + v * i12 + w * i22
            Jb[i, k] = q[at_J]
            Jg[m] = J[i] / q[at_J]
