"""The closest point of a surface: FEBio's projection for contact of nodes, and of integration points, on facets.

The node of the surface nearest to a point is found, then the facet around it that holds the point's projection.
Where none does (the point lies before a convex edge or corner), the facets around are searched, then the edges
and the node itself are taken (FEBio 4.11, FEClosestPointProjection).
"""

from __future__ import annotations

import numpy as np

from ..jit import kernel
from . import facets, tree


@kernel
def _newton(T, x, nodes, n, p, H, G, C, w, rs, q):
    """Minimise |q(r, s) - p| from the present rs; False where 50 iterations do not."""
    t = w[:3]
    for k in range(52):
        facets.shape(T, n, rs[0], rs[1], H)
        facets.slopes(T, n, rs[0], rs[1], G)
        facets.curvatures(T, n, rs[0], rs[1], C)
        facets.place(x, nodes, n, H, q)
        facets.tangents(x, nodes, n, G, t)
        a, b, c = facets.dot(t[0], t[0]), facets.dot(t[0], t[1]), facets.dot(t[1], t[1])
        u = v = 0.0
        for i in range(3):
            f = q[i] - p[i]
            u += f * t[0, i]
            v += f * t[1, i]
            for m in range(n):
                y = f * x[nodes[m], i]
                a += C[m, 0] * y
                b += C[m, 1] * y
                c += C[m, 2] * y
        det = a * c - b * b
        dr, ds = -(c * u - b * v) / det, -(a * v - b * u) / det
        if dr * dr + ds * ds < 1e-10:
            return True
        if k > 50:
            return False
        rs[0] += dr
        rs[1] += ds
    return False


@kernel
def _newton_quad(x, nodes, p, w, rs, q):
    """:func:`_newton` of a quadrilateral of 4 nodes, in FEBio's order of operations.

    A point before the edge of two facets of one plane is as far from the one as from the other: rounding decides which
    is taken, and with it, once the plane bends, the side to which a symmetric model gives way.
    """
    px, H, Hr, Hs = w[4, :4], w[5, :4], w[6, :4], w[7, :4]
    for a in range(4):
        m = nodes[a]
        px[a] = p[0] * x[m, 0] + p[1] * x[m, 1] + p[2] * x[m, 2]
        for b in range(4):
            k = nodes[b]
            w[a, b] = x[m, 0] * x[k, 0] + x[m, 1] * x[k, 1] + x[m, 2] * x[k, 2]
    done = False
    for k in range(52):
        r, s = rs[0], rs[1]
        for a in range(4):
            g = 1.0 if a == 1 or a == 2 else -1.0
            h = 1.0 if a > 1 else -1.0
            H[a] = 0.25 * (1.0 + g * r) * (1.0 + h * s)
            Hr[a] = 0.25 * g * (1.0 + h * s)
            Hs[a] = 0.25 * h * (1.0 + g * r)
        u = v = aa = ab = ba = bb = 0.0
        for a in range(4):
            t = 0.25 if a == 0 or a == 2 else -0.25
            u -= px[a] * Hr[a]
            v -= px[a] * Hs[a]
            ab += px[a] * t
            ba += px[a] * t
            for b in range(4):
                z = w[a, b]
                u -= -H[b] * Hr[a] * z
                v -= -H[b] * Hs[a] * z
                aa -= z * (Hr[a] * Hr[b])
                bb -= z * (Hs[a] * Hs[b])
                ab -= z * (Hr[a] * Hs[b] + t * H[b])
                ba -= z * (Hs[a] * Hr[b] + t * H[b])
        det = aa * bb - ab * ba
        dr, ds = (bb * u - ab * v) / det, (aa * v - ba * u) / det
        done = dr * dr + ds * ds < 1e-10  # FEBio leaves the last increment out, which its answers show
        if done or k > 50:
            break
        rs[0] += dr
        rs[1] += ds
    for i in range(3):
        q[i] = x[nodes[0], i] * H[0] + x[nodes[1], i] * H[1] + x[nodes[2], i] * H[2] + x[nodes[3], i] * H[3]
    return done


@kernel
def project(T, x, nodes, n, p, H, G, C, w, rs, q):
    """Project p on a facet: q (3,) and its coordinates rs (2,), which start the search."""
    if n == 4:
        if not _newton_quad(x, nodes, p, w, rs, q):
            _approach(x, nodes, p, w, rs, q)
        return
    if n > 4:
        _newton(T, x, nodes, n, p, H, G, C, w, rs, q)
        return
    e, f = w[0], w[1]
    ep = fp = 0.0
    for i in range(3):
        e[i], f[i] = x[nodes[1], i] - x[nodes[0], i], x[nodes[2], i] - x[nodes[0], i]
        ep += e[i] * (p[i] - x[nodes[0], i])
        fp += f[i] * (p[i] - x[nodes[0], i])
    ee, ef, ff = facets.dot(e, e), facets.dot(e, f), facets.dot(f, f)
    det = ee * ff - ef * ef
    rs[0], rs[1] = (ff * ep - ef * fp) / det, (ee * fp - ef * ep) / det
    for i in range(3):
        q[i] = x[nodes[0], i] + rs[0] * e[i] + rs[1] * f[i]


@kernel
def _approach(x, nodes, p, w, rs, q):
    """Project points between the facet's middle and p in turn, where p itself fails."""
    at, to = w[8], w[9]
    for i in range(3):
        at[i] = 0.25 * (x[nodes[0], i] + x[nodes[1], i] + x[nodes[2], i] + x[nodes[3], i])
    rs[0] = rs[1] = 0.0
    step, level = 0.5, 1
    for _ in range(21):
        for i in range(3):
            to[i] = at[i] * (1.0 - step) + p[i] * step
        if _newton_quad(x, nodes, to, w, rs, q):
            level -= 1
            if level == 0:
                for i in range(3):
                    at[i] = to[i]
                step = 1.0
            else:
                step *= 2.0
        else:
            level += 1
            step *= 0.5
        if level < 0 or step <= 0.1:
            return


@kernel
def _touches(conn, count, e, node):
    found = False
    for a in range(count[e]):
        found = found or conn[e, a] == node
    return found


@kernel
def _allowed(conn, count, first, star, i, node, itself, own):
    """May local node i be the nearest? Not where a facet around it is ``own`` or has the node ``itself``."""
    if itself >= 0 and node == itself:
        return False
    if itself < 0 and own < 0:
        return True
    for k in range(first[i], first[i + 1]):
        if star[k] == own or (itself >= 0 and _touches(conn, count, star[k], itself)):
            return False
    return True


@kernel
def nearest_node(x, conn, count, nodes, first, star, order, boxes, p, radius, itself, own, stack):
    """Local index of the node nearest to p within ``radius`` (0: anywhere) that :func:`_allowed` allows, or -1."""
    L, m = (len(boxes) + 1) // 2, len(order)
    best, d2 = -1, radius * radius if radius > 0.0 else np.inf
    stack[0], top = 0, 1
    while top > 0:
        top -= 1
        k = stack[top]
        if tree.distance2(boxes[k], p) > d2:
            continue
        if k < L - 1:
            a, b = 2 * k + 1, 2 * k + 2
            if tree.distance2(boxes[a], p) < tree.distance2(boxes[b], p):
                a, b = b, a
            stack[top], stack[top + 1] = a, b
            top += 2
            continue
        l = k - (L - 1)
        for j in range(m * l // L, m * (l + 1) // L):
            i = order[j]
            g = 0.0
            for c in range(3):
                g += (x[nodes[i], c] - p[c]) ** 2
            nearer = g < d2 or (g == d2 and (best < 0 or i < best))
            if nearer and _allowed(conn, count, first, star, i, nodes[i], itself, own):
                best, d2 = i, g
    return best


@kernel
def _square(q, p):
    return (q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2 + (q[2] - p[2]) ** 2


@kernel
def _try(T, x, conn, count, e, p, tol, H, G, C, w, most, out):
    """Project p on facet e: True, and out (6,) = r, s, q and |q - p|^2, where inside and nearer than ``most``."""
    rs, q = out[6:8], out[8:11]
    rs[0] = rs[1] = 0.0
    project(T, x, conn[e], count[e], p, H, G, C, w, rs, q)
    if not facets.inside(count[e], rs[0], rs[1], tol):
        return False
    d = _square(q, p)
    if not d < most:
        return False
    out[0], out[1], out[5] = rs[0], rs[1], d
    for i in range(3):
        out[2 + i] = q[i]
    return True


@kernel
def closest(T, x, conn, count, nodes, local, neighbours, first, star, i, p, tol, special, H, G, C, w, seen, out):
    """The facet around local node i that holds the projection of p, or -1; out (14,): r, s, q (3,) and work.

    seen (64,): work.
    """
    best, d2 = -1, np.inf
    for k in range(first[i], first[i + 1]):
        if _try(T, x, conn, count, star[k], p, tol, H, G, C, w, d2, out):
            best, d2 = star[k], out[5]
    if best >= 0 or not special:
        return best
    d2 = _square(x[nodes[i]], p)
    seen[:] = -1
    for k in range(first[i], first[i + 1]):  # facets around the neighbours
        e = star[k]
        for a in range(count[e]):
            m = local[e, a]
            for j in range(first[m], first[m + 1]):
                f = star[j]
                new = not _touches(conn, count, f, nodes[i])  # others were tried above
                for b in range(len(seen)):
                    if seen[b] == f or seen[b] < 0:
                        new = new and seen[b] < 0
                        seen[b] = f
                        break
                if new and _try(T, x, conn, count, f, p, tol, H, G, C, w, d2, out):
                    best, d2 = f, out[5]
    if best >= 0:
        return best
    best = _edge(T, x, conn, count, nodes, local, neighbours, first, star, i, p, d2, tol, H, G, C, w, out)
    if best >= 0:
        return best
    return _corner(x, conn, count, nodes, neighbours, first, star, i, out)


@kernel
def _edge(T, x, conn, count, nodes, local, neighbours, first, star, i, p, d2, tol, H, G, C, w, out):
    """The facet with an edge at local node i that p projects on; edges of the surface's border do not count."""
    best, on = -1, out[11:14]
    for k in range(first[i], first[i + 1]):
        e = star[k]
        sides = 4 if count[e] in (4, 8, 9) else 3
        for a in range(sides):
            b = (a + 1) % sides
            if neighbours[e, a] < 0 or (local[e, a] != i and local[e, b] != i):
                continue
            u, v = conn[e, a], conn[e, b]
            l = d = 0.0
            for c in range(3):
                g = x[v, c] - x[u, c]
                d += g * g
                l += g * (p[c] - x[u, c])
            if d == 0.0 or l < 0.0 or l > d:
                continue
            for c in range(3):
                on[c] = x[u, c] + l / d * (x[v, c] - x[u, c])
            rs, q = out[6:8], out[8:11]
            rs[0] = rs[1] = 0.0
            project(T, x, conn[e], count[e], on, H, G, C, w, rs, q)
            if facets.inside(count[e], rs[0], rs[1], tol) and _square(q, p) < d2:
                best, d2 = e, _square(q, p)
                out[0], out[1] = rs[0], rs[1]
                for c in range(3):
                    out[2 + c] = q[c]
    return best


@kernel
def _corner(x, conn, count, nodes, neighbours, first, star, i, out):
    """The node itself, with the first facet around it, where it is not on the surface's border."""
    m = nodes[i]
    for k in range(first[i], first[i + 1]):
        e = star[k]
        sides = 4 if count[e] in (4, 8, 9) else 3
        for a in range(sides):
            if neighbours[e, a] < 0 and (conn[e, a] == m or conn[e, (a + 1) % sides] == m):
                return -1
    if first[i + 1] == first[i]:
        return -1
    out[0] = out[1] = 0.0  # FEBio's coordinates of such a point, which are those of the facet's middle
    for c in range(3):
        out[2 + c] = x[m, c]
    return star[first[i]]


@kernel
def follow(
    T, x, conn, count, nodes, local, neighbours, first, star, order, boxes, points, itself, own, tol, radius, special,
    keep, update, partner, rs, place,
):  # fmt: skip
    """Closest points of a surface to points (q, 3).

    conn, local (f, 9) and count (f,): nodes of the surface's facets, in the mesh and in ``nodes``; first, star: the
    facets around each node; neighbours (f, 4): facets beyond the edges or -1; itself, own (q,): node or facet of the
    surface that the point belongs to, or -1. partner (q,): the facet before or -1, kept (if ``keep``) while the
    projection stays inside, else searched anew (if ``update``); rs (q, 2), place (q, 3): where.
    """
    H, G, C, w = np.empty(9), np.empty((9, 2)), np.empty((9, 3)), np.empty((10, 4))
    out, stack, seen = np.zeros(14), np.empty(64, np.int64), np.empty(64, np.int64)
    for k in range(len(partner)):
        e, p = partner[k] if keep else -1, points[k]
        if e >= 0:
            project(T, x, conn[e], count[e], p, H, G, C, w, rs[k], place[k])
            if update and not facets.inside(count[e], rs[k, 0], rs[k, 1], tol):
                e = -1
        if e < 0 and update:
            i = nearest_node(
                x, conn, count, nodes, first, star, order, boxes, p, radius, itself[k], own[k], stack
            )  # fmt: skip
            if i >= 0:
                e = closest(
                    T, x, conn, count, nodes, local, neighbours, first, star, i, p, tol, special, H, G, C, w, seen,
                    out,
                )  # fmt: skip
            if e >= 0:
                rs[k, 0], rs[k, 1] = out[0], out[1]
                for c in range(3):
                    place[k, c] = out[2 + c]
        partner[k] = e


