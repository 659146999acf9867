#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Reference answers for near_incompressible.cpp: a mixed method of another order that does not lock.

Nine-node quadrilaterals (plane strain) or 27-node hexahedra, with the volume change projected onto the linear
functions of each element (Q2/P1 discontinuous, which satisfies the inf-sup condition; Simo, Taylor & Pister
1985):  E(u) = int mu/2 (I1 - 3) - mu ln J + lambda/2 (ln theta)^2,  theta = 1 + P(J - 1),
P the L2 projection. Neo-Hookean with the logarithm; mu is kept, lambda = 2 mu nu / (1 - 2 nu).
Needs numpy and scipy. Usage: near_incompressible_reference.py cook|block cells...
Prints problem,nu,cells,unknowns,answer (for cook a corner's before it).
"""
import itertools
import sys

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

NUS = (0.3, 0.4, 0.45, 0.49, 0.499, 0.4999)


class Q2P1:
    """Mapped grid of Q2 elements; `cells` per axis, `place` maps the unit cube's grid to rest positions."""

    def __init__(self, cells, place):
        d = self.d = len(cells)
        counts = [2 * n + 1 for n in cells]
        grid = np.stack(np.meshgrid(*[np.linspace(0, 1, c) for c in counts], indexing="ij"), -1).reshape(-1, d)
        self.X = place(grid)
        number = np.arange(len(grid)).reshape(counts)
        corner = np.stack(np.meshgrid(*[2 * np.arange(n) for n in cells], indexing="ij"), -1).reshape(-1, d)
        local = list(itertools.product(range(3), repeat=d))
        self.nodes = np.stack([number[tuple((corner + o).T)] for o in local], -1)
        x, w = np.polynomial.legendre.leggauss(3)
        points = np.array(list(itertools.product(x, repeat=d)))
        weights = np.prod(np.array(list(itertools.product(w, repeat=d))), axis=1)
        one = lambda t: np.stack([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2], -1)
        slope = lambda t: np.stack([t - 0.5, -2 * t, t + 0.5], -1)
        N, dN = one(points), slope(points)  # (q, axis, 3)
        shape = np.stack([np.prod([N[:, a, o[a]] for a in range(d)], axis=0) for o in local], -1)
        dshape = np.stack([np.stack([np.prod([(dN if a == b else N)[:, a, o[a]] for a in range(d)], axis=0)
                                     for b in range(d)], -1) for o in local], 1)  # (q, n, d)
        Xe = self.X[self.nodes]
        jacobian = np.einsum("qnb,ena->eqab", dshape, Xe)
        self.w = np.linalg.det(jacobian) * weights
        assert (self.w > 0).all()
        self.g = np.einsum("qnb,eqba->eqna", dshape, np.linalg.inv(jacobian))
        # linear functions of position, made orthonormal in each element
        xq = np.einsum("qn,ena->eqa", shape, Xe)
        phi = np.concatenate([np.ones(xq.shape[:2] + (1,)), xq - xq.mean(axis=1, keepdims=True)], -1)
        L = np.linalg.cholesky(np.einsum("eq,eqm,eqk->emk", self.w, phi, phi))
        self.phi = np.einsum("emk,eqk->eqm", np.linalg.inv(L), phi)
        dofs = (d * self.nodes[:, :, None] + np.arange(d)).reshape(len(self.nodes), -1)
        self.dofs = dofs
        m = dofs.shape[1]
        self.rows, self.cols = np.repeat(dofs, m, axis=1).ravel(), np.tile(dofs, (1, m)).ravel()

    def cofactor(self, F):
        return np.linalg.det(F)[..., None, None] * np.swapaxes(np.linalg.inv(F), -1, -2)

    def evaluate(self, u, mu, lam, pressure=None):
        """Gradient of E and, with the pressure in the geometric part given, its Hessian, the pressure (by
        element, in the orthonormal functions) and its derivative; None where some J is not positive."""
        d, g, w = self.d, self.g, self.w
        F = np.eye(d) + np.einsum("ena,eqnb->eqab", u.reshape(-1, d)[self.nodes], g)
        J = np.linalg.det(F)
        theta = 1 + np.einsum("eqm,em->eq", self.phi, np.einsum("eq,eqm,eq->em", w, self.phi, J - 1))
        if not (J > 0).all() or not (theta > 0).all():
            return None
        modes = np.einsum("eq,eqm,eq->em", w, self.phi, lam * np.log(theta) / theta)
        p = np.einsum("eqm,em->eq", self.phi, modes)
        c = np.einsum("eqab,eqnb->eqna", self.cofactor(F), g)
        Fg = np.einsum("eqab,eqnb->eqna", F, g)
        force = np.einsum("eq,eqna->ena", w, mu * Fg) + np.einsum("eq,eqna->ena", w * (p - mu / J), c)
        r = np.zeros(u.size)
        np.add.at(r, self.dofs.ravel(), force.ravel())
        if pressure is None:
            return r
        p = np.einsum("eqm,em->eq", self.phi, pressure)
        n = g.shape[2]
        K = np.einsum("eqi,eqj->eij", (w * mu / J**2)[..., None] * c.reshape(c.shape[:2] + (-1,)),
                      c.reshape(c.shape[:2] + (-1,)))
        gg = np.einsum("eq,eqna,eqma->enm", w * mu, g, g)
        K = K.reshape(-1, n, d, n, d)
        for a in range(d):
            K[:, :, a, :, a] += gg
        s = w * (p - mu / J)
        if d == 2:
            cross = np.einsum("eq,eqn,eqm->enm", s, g[..., 0], g[..., 1])
            cross = cross - np.swapaxes(cross, 1, 2)
            K[:, :, 0, :, 1] += cross
            K[:, :, 1, :, 0] -= cross
        else:
            for k in range(3):  # component k of g_i x g_j, carried by F
                a, b = (k + 1) % 3, (k + 2) % 3
                for c3 in range(3):
                    t = np.einsum("eqn,eqm->enm", (s * F[..., c3, k])[..., None] * g[..., a], g[..., b])
                    t = t - np.swapaxes(t, 1, 2)
                    i, j = (c3 + 1) % 3, (c3 + 2) % 3
                    K[:, :, i, :, j] += t
                    K[:, :, j, :, i] -= t
        G = np.einsum("eq,eqm,eqna->emna", w, self.phi, c).reshape(len(g), -1, n * d)
        D = np.einsum("eq,eqm,eqk->emk", w * lam * (1 - np.log(theta)) / theta**2, self.phi, self.phi)
        DG = np.einsum("emk,ekj->emj", D, G)
        K = K.reshape(-1, n * d, n * d) + np.einsum("emi,emj->eij", G, DG, optimize=True)
        return r, sp.csc_matrix((K.ravel(), (self.rows, self.cols)), shape=(u.size, u.size)), modes, DG

    def solve(self, u, pressure, fixed, values, load, mu, lam):
        """Newton's method in displacement and pressure; the prescribed values are in place after a full step."""
        free = np.setdiff1d(np.arange(u.size), fixed)
        for _ in range(40):
            r, K, modes, DG = self.evaluate(u, mu, lam, pressure)
            jump = np.zeros(u.size)
            jump[fixed] = values - u[fixed]
            Kff = K[free][:, free]
            step = jump.copy()
            step[free] = spla.splu(Kff, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                                   options=dict(SymmetricMode=True)).solve((load - r - K @ jump)[free])
            scale = 1.0
            while self.evaluate(u + scale * step, mu, lam) is None:
                scale /= 2
            u = u + scale * step
            pressure = pressure + scale * (modes + np.einsum("emj,ej->em", DG, step[self.dofs]) - pressure)
            if scale == 1 and np.abs(step).max() < 1e-9 * np.abs(u).max():
                return u, pressure, self.evaluate(u, mu, lam)
        raise RuntimeError("not converged")


def cook(n, grade):
    """Cook's membrane: vertical displacement in mm of (48, 60) and (48, 52); mu = 0.4225 N/mm^2, 1 N/mm on the
    right. The grid is graded towards the held side, at whose ends the stress is singular."""
    def place(t):
        s, r = t[:, 0] ** grade, t[:, 1]
        if grade > 1:
            r = r**grade / (r**grade + (1 - r) ** grade)
        return np.stack([48 * s, 44 * s + (44 - 28 * s) * r], -1)

    body = Q2P1((n, n), place)
    left, right = np.where(body.X[:, 0] < 1e-9)[0], np.where(body.X[:, 0] > 48 - 1e-9)[0]
    fixed = np.concatenate([2 * left, 2 * left + 1])
    load = np.zeros(2 * len(body.X))
    right = right[np.argsort(body.X[right, 1])]
    y = body.X[right, 1]
    shape_by_slope = np.array([[-3, 4, -1], [-4, 0, 4], [1, -4, 3]]) / 6  # integrals of N_i dN_j
    for k in range(n):
        load[2 * right[2 * k:2 * k + 3] + 1] += shape_by_slope @ y[2 * k:2 * k + 3] / 16
    u, p = np.zeros_like(load), np.zeros((n * n, 3))
    mu = 0.4225
    for nu in NUS:
        lam = 2 * mu * nu / (1 - 2 * nu)
        for k in (np.arange(1, 6) / 5 if nu == NUS[0] else [1]):
            u, p, _ = body.solve(u, p, fixed, np.zeros(len(fixed)), k * load, mu, lam)
        tip = right[-1]
        middle = right[np.argmin(np.abs(body.X[right, 1] - 52))]
        print(f"cook,{nu},{n} graded {grade},{u.size},{u[2 * tip + 1]:.6f},{u[2 * middle + 1]:.6f}", flush=True)


def block(n, grade):
    """Force in N on a unit cube (mu = 1 Pa) bonded at both ends and compressed by 10 %; an eighth of it. The
    grid is graded towards the bonded edges, where the stress is singular."""
    body = Q2P1((n, n, n), lambda t: 0.5 * (1 - (1 - t) ** grade))
    X = body.X
    bonded = np.where(X[:, 2] > 0.5 - 1e-9)[0]
    fixed = {}
    for axis in range(3):
        for i in np.where(X[:, axis] < 1e-9)[0]:
            fixed[3 * i + axis] = 0.0
    for i in bonded:
        fixed.update({3 * i: 0.0, 3 * i + 1: 0.0, 3 * i + 2: -0.05})
    at = np.array(sorted(fixed))
    values = np.array([fixed[k] for k in at])
    u, p = np.zeros(3 * len(X)), np.zeros((n**3, 4))
    for nu in NUS:
        lam = 2 * nu / (1 - 2 * nu)
        for k in (np.arange(1, 3) / 2 if nu == NUS[0] else [1]):
            u, p, r = body.solve(u, p, at, k * values, np.zeros_like(u), 1.0, lam)
        print(f"block,{nu},{n} graded {grade},{u.size},{-4 * r[3 * bonded + 2].sum():.6f}", flush=True)


if __name__ == "__main__":
    for cells in sys.argv[2:]:
        (cook if sys.argv[1] == "cook" else block)(int(cells), 1.5)
