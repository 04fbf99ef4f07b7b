"""V3 in the plane (`scenes.Axes`) in NVIDIA Warp on the processor, by the schemes of ours: hats with FLIP and MUSL,
quadratic B-splines with APIC and USL. Neo-Hookean, double precision, written from scratch for this project.

Warp's processor backend runs a kernel on one thread. Launches are recorded once and called in every step.
"""
import numpy as np
import warp as wp

import scenes
from scenes import Axes

wp.config.quiet = True
wp.config.enable_backward = False
wp.init()

R, V2, V3, M2 = wp.float64, wp.vec2d, wp.vec3d, wp.mat22d
Scalars, Vectors, Matrices = wp.array(dtype=R), wp.array(dtype=V2), wp.array(dtype=M2)
Count = wp.array(dtype=int)
Momenta, Fields = wp.array2d(dtype=V3), wp.array2d(dtype=V2)

AMPLITUDE, K, OMEGA = (wp.constant(R(a)) for a in (Axes.AMPLITUDE, Axes.K, Axes.OMEGA))
PHASE_X, PHASE_Y = (wp.constant(R(a)) for a in Axes.PHASES)
LAME, SHEAR = wp.constant(R(Axes.LAME)), wp.constant(R(Axes.SHEAR))
ZERO, HALF, ONE, TWO = (wp.constant(R(a)) for a in (0, 0.5, 1, 2))
WIDE, FOUR = wp.constant(R(0.75)), wp.constant(R(4))
PAD = wp.constant(Axes.PAD)


@wp.func
def body_force(start: V2, t: R):
    """By where a particle started."""
    sx, sy = wp.sin(OMEGA * t + PHASE_X), wp.sin(OMEGA * t + PHASE_Y)
    u = AMPLITUDE * V2(wp.sin(K * start[0]) * sx, wp.sin(K * start[1]) * sy)
    fx = ONE + AMPLITUDE * K * wp.cos(K * start[0]) * sx
    fy = ONE + AMPLITUDE * K * wp.cos(K * start[1]) * sy
    part = LAME * (ONE - wp.log(fx * fy)) + SHEAR
    inertia = OMEGA * OMEGA
    return V2(
        u[0] * (K * K * (SHEAR + part / (fx * fx)) - inertia),
        u[1] * (K * K * (SHEAR + part / (fy * fy)) - inertia),
    )


@wp.func
def kirchhoff(f: M2):
    """Kirchhoff stress, neo-Hookean: by the reference volume it is the Cauchy stress by the volume."""
    one = wp.identity(n=2, dtype=R)
    return SHEAR * (f * wp.transpose(f) - one) + LAME * wp.log(wp.determinant(f)) * one


@wp.func
def still(i: int, j: int, last: int, value: V2):
    """No component across planes of symmetry."""
    x, y = value[0], value[1]
    if i == PAD or i == last - PAD:
        x = ZERO
    if j == PAD or j == last - PAD:
        y = ZERO
    return V2(x, y)


@wp.func
def kept(x: V2, start: V2, h: R, lost: Count):
    """Where a particle is; what would leave the box of nodes is counted and put back to its start, for the run is over."""
    low, high = -h, ONE + h
    # Written so that what is not a number is outside.
    if x[0] > low and x[0] < high and x[1] > low and x[1] < high:
        return x
    wp.atomic_add(lost, 0, 1)
    return start


# ---------------------------------------------------------------- hats, FLIP, MUSL
@wp.func
def hat(side: int, xi: R):
    if side == 0:
        return ONE - xi
    return xi


@wp.func
def slope(side: int, h: R):
    if side == 0:
        return -ONE / h
    return ONE / h


@wp.kernel
def hats_scatter(
    starts: Vectors, x: Vectors, v: Vectors, f: Matrices, t: Scalars, h: R, mass: R, momentum: Momenta, force: Fields
):
    p = wp.tid()
    at = x[p] / h
    bi, bj = int(wp.floor(at[0])), int(wp.floor(at[1]))
    xi = at - V2(R(bi), R(bj))
    tau, b = kirchhoff(f[p]) * mass, body_force(starts[p], t[0]) * mass
    for i in range(2):
        for j in range(2):
            wi, wj = hat(i, xi[0]), hat(j, xi[1])
            w = wi * wj * mass
            wp.atomic_add(momentum, bi + i + PAD, bj + j + PAD, V3(w * v[p][0], w * v[p][1], w))
            inner = tau * V2(slope(i, h) * wj, wi * slope(j, h))
            wp.atomic_add(force, bi + i + PAD, bj + j + PAD, wi * wj * b - inner)


@wp.kernel
def hats_move(momentum: Momenta, force: Fields, dt: R):
    i, j = wp.tid()
    q = momentum[i, j]
    if q[2] > ZERO:
        last = momentum.shape[0] - 1
        a = still(i, j, last, force[i, j] / q[2])
        new = still(i, j, last, V2(q[0], q[1]) / q[2]) + dt * a
        momentum[i, j] = V3(new[0], new[1], q[2])
        force[i, j] = a


@wp.kernel
def hats_velocities(
    x: Vectors, v: Vectors, moved: Vectors, h: R, mass: R, dt: R, momentum: Momenta, force: Fields, again: Fields
):
    p = wp.tid()
    at = x[p] / h
    bi, bj = int(wp.floor(at[0])), int(wp.floor(at[1]))
    xi = at - V2(R(bi), R(bj))
    nodal, rise = V2(), V2()
    for i in range(2):
        for j in range(2):
            w = hat(i, xi[0]) * hat(j, xi[1])
            q = momentum[bi + i + PAD, bj + j + PAD]
            nodal = nodal + w * V2(q[0], q[1])
            rise = rise + w * force[bi + i + PAD, bj + j + PAD]
    new = v[p] + dt * rise
    v[p] = new
    moved[p] = x[p] + dt * nodal
    for i in range(2):
        for j in range(2):
            w = hat(i, xi[0]) * hat(j, xi[1]) * mass
            wp.atomic_add(again, bi + i + PAD, bj + j + PAD, w * new)


@wp.kernel
def hats_move_again(momentum: Momenta, again: Fields):
    i, j = wp.tid()
    m = momentum[i, j][2]
    if m > ZERO:
        again[i, j] = still(i, j, momentum.shape[0] - 1, again[i, j] / m)


@wp.kernel
def hats_gather(
    starts: Vectors, x: Vectors, moved: Vectors, f: Matrices, lost: Count, h: R, dt: R, again: Fields
):
    p = wp.tid()
    at = x[p] / h
    bi, bj = int(wp.floor(at[0])), int(wp.floor(at[1]))
    xi = at - V2(R(bi), R(bj))
    gradient = M2()
    for i in range(2):
        for j in range(2):
            g = V2(slope(i, h) * hat(j, xi[1]), hat(i, xi[0]) * slope(j, h))
            gradient = gradient + wp.outer(again[bi + i + PAD, bj + j + PAD], g)
    f[p] = f[p] + dt * (gradient * f[p])
    x[p] = kept(moved[p], starts[p], h, lost)


# ---------------------------------------------------------------- quadratic B-splines, APIC, USL
@wp.func
def spline(xi: R):
    """Weights of the node before, at and after the nearest one."""
    return V3(HALF * (HALF - xi) * (HALF - xi), WIDE - xi * xi, HALF * (HALF + xi) * (HALF + xi))


@wp.func
def spline_slope(xi: R, h: R):
    return V3(xi - HALF, -TWO * xi, xi + HALF) / h


@wp.kernel
def splines_scatter(
    starts: Vectors, x: Vectors, v: Vectors, affine: Matrices, f: Matrices, t: Scalars, h: R, mass: R,
    momentum: Momenta, force: Fields,
):
    p = wp.tid()
    at = x[p] / h
    bi, bj = int(wp.floor(at[0] + HALF)), int(wp.floor(at[1] + HALF))
    xi = at - V2(R(bi), R(bj))
    wx, wy, gx, gy = spline(xi[0]), spline(xi[1]), spline_slope(xi[0], h), spline_slope(xi[1], h)
    tau, b = kirchhoff(f[p]) * mass, body_force(starts[p], t[0]) * mass
    for i in range(3):
        for j in range(3):
            r = h * V2(R(i - 1) - xi[0], R(j - 1) - xi[1])
            w = wx[i] * wy[j]
            q = (w * mass) * (v[p] + affine[p] * r)
            wp.atomic_add(momentum, bi + i - 1 + PAD, bj + j - 1 + PAD, V3(q[0], q[1], w * mass))
            inner = tau * V2(gx[i] * wy[j], wx[i] * gy[j])
            wp.atomic_add(force, bi + i - 1 + PAD, bj + j - 1 + PAD, w * b - inner)


@wp.func
def fold(momentum: Momenta, force: Fields, fi: int, fj: int, bi: int, bj: int, sign: V2, copies: int):
    """The node behind a plane of symmetry gives its mirrored sums to the one in front, or becomes the image of that."""
    if copies == 1:
        momentum[bi, bj] = wp.cw_mul(momentum[fi, fj], V3(sign[0], sign[1], ONE))
        force[bi, bj] = wp.cw_mul(force[fi, fj], sign)
    else:
        momentum[fi, fj] = momentum[fi, fj] + wp.cw_mul(momentum[bi, bj], V3(sign[0], sign[1], ONE))
        force[fi, fj] = force[fi, fj] + wp.cw_mul(force[bi, bj], sign)


@wp.kernel
def splines_mirror(momentum: Momenta, force: Fields, axis: int, copies: int):
    k = wp.tid()
    high = momentum.shape[0] - 1 - PAD
    if axis == 0:
        sign = V2(-ONE, ONE)
        fold(momentum, force, PAD + 1, k, PAD - 1, k, sign, copies)
        fold(momentum, force, high - 1, k, high + 1, k, sign, copies)
    else:
        sign = V2(ONE, -ONE)
        fold(momentum, force, k, PAD + 1, k, PAD - 1, sign, copies)
        fold(momentum, force, k, high - 1, k, high + 1, sign, copies)


@wp.kernel
def splines_move(momentum: Momenta, force: Fields, dt: R):
    i, j = wp.tid()
    q = momentum[i, j]
    if q[2] > ZERO:
        new = still(i, j, momentum.shape[0] - 1, (V2(q[0], q[1]) + dt * force[i, j]) / q[2])
        momentum[i, j] = V3(new[0], new[1], q[2])


@wp.kernel
def splines_gather(
    starts: Vectors, x: Vectors, v: Vectors, affine: Matrices, f: Matrices, lost: Count, h: R, dt: R, momentum: Momenta
):
    p = wp.tid()
    at = x[p] / h
    bi, bj = int(wp.floor(at[0] + HALF)), int(wp.floor(at[1] + HALF))
    xi = at - V2(R(bi), R(bj))
    wx, wy, gx, gy = spline(xi[0]), spline(xi[1]), spline_slope(xi[0], h), spline_slope(xi[1], h)
    nodal, moment, gradient = V2(), M2(), M2()
    for i in range(3):
        for j in range(3):
            q = momentum[bi + i - 1 + PAD, bj + j - 1 + PAD]
            velocity = V2(q[0], q[1])
            w = wx[i] * wy[j]
            nodal = nodal + w * velocity
            moment = moment + wp.outer(w * velocity, h * V2(R(i - 1) - xi[0], R(j - 1) - xi[1]))
            gradient = gradient + wp.outer(velocity, V2(gx[i] * wy[j], wx[i] * gy[j]))
    v[p] = nodal
    affine[p] = (FOUR / (h * h)) * moment
    f[p] = f[p] + dt * (gradient * f[p])
    x[p] = kept(x[p] + dt * nodal, starts[p], h, lost)


# ---------------------------------------------------------------- scenes
class State:
    """Particles, nodes, and the launches of a step."""

    def __init__(self, scene):
        self.scene = scene
        self.starts, self.x = self.vectors(scene.starts), self.vectors(scene.starts)
        self.v = self.vectors(scene.velocities)
        self.f = wp.array(np.tile(np.eye(2), (len(scene), 1, 1)), dtype=M2, device="cpu")
        self.lost = wp.zeros(1, dtype=int, device="cpu")
        self.t = wp.zeros(1, dtype=R, device="cpu")
        self.momentum, self.force = self.grid(V3), self.grid(V2)
        # Recorded launches do not hold their arrays.
        self.cleared, self.launches, self.inputs = [self.momentum, self.force], [], []

    def vectors(self, values):
        return wp.array(values, dtype=V2, device="cpu")

    def grid(self, kind):
        return wp.zeros((self.scene.nodes,) * 2, dtype=kind, device="cpu")

    def then(self, kernel, over, inputs):
        self.inputs.append(inputs)
        self.launches.append(wp.launch(kernel, over, inputs, device="cpu", record_cmd=True))

    def advance(self, first, end):
        now = self.t.numpy()
        for n in range(first, end):
            now[0] = n * self.scene.dt
            for nodes in self.cleared:
                nodes.zero_()
            for launch in self.launches:
                launch.launch()

    def look(self):
        return self.x.numpy(), self.v.numpy(), self.f.numpy(), self.lost.numpy()[0]


def with_hats(scene):
    s = State(scene)
    moved, again = wp.zeros_like(s.x), s.grid(V2)
    s.cleared.append(again)
    n, nodes, h, dt, m = len(scene), (scene.nodes,) * 2, scene.h, scene.dt, scene.mass
    s.then(hats_scatter, n, [s.starts, s.x, s.v, s.f, s.t, h, m, s.momentum, s.force])
    s.then(hats_move, nodes, [s.momentum, s.force, dt])
    s.then(hats_velocities, n, [s.x, s.v, moved, h, m, dt, s.momentum, s.force, again])
    s.then(hats_move_again, nodes, [s.momentum, again])
    s.then(hats_gather, n, [s.starts, s.x, moved, s.f, s.lost, h, dt, again])
    return s.advance, s.look


def with_splines(scene):
    s = State(scene)
    affine = wp.zeros(len(scene), dtype=M2, device="cpu")
    n, nodes, h, dt, m = len(scene), (scene.nodes,) * 2, scene.h, scene.dt, scene.mass
    s.then(splines_scatter, n, [s.starts, s.x, s.v, affine, s.f, s.t, h, m, s.momentum, s.force])
    # Splines reach behind the planes of symmetry: first all give, then all copy, for the sake of corners.
    for copies in range(2):
        for axis in range(2):
            s.then(splines_mirror, scene.nodes, [s.momentum, s.force, axis, copies])
    s.then(splines_move, nodes, [s.momentum, s.force, dt])
    s.then(splines_gather, n, [s.starts, s.x, s.v, affine, s.f, s.lost, h, dt, s.momentum])
    return s.advance, s.look


scenes.run_axes(f"Warp {wp.__version__}", {"linear FLIP-MUSL": with_hats, "quadratic APIC": with_splines})
