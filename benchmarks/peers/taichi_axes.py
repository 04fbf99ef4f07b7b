"""V3 in the plane (`scenes.Axes`) in Taichi on one thread, by the schemes of ours: hats with FLIP and MUSL, quadratic
B-splines with APIC and USL. Neo-Hookean, double precision, written from scratch for this project.

A kernel makes all steps between two looks, serially: so Taichi needs no atomic additions, and no time for launches.
"""
import numpy as np
import taichi as ti

import scenes
from scenes import Axes

ti.init(arch=ti.cpu, cpu_max_num_threads=1, default_fp=ti.f64, fast_math=True, log_level=ti.ERROR)

vec2 = ti.types.vector(2, ti.f64)
vec3 = ti.types.vector(3, ti.f64)
mat2 = ti.types.matrix(2, 2, ti.f64)
Vectors = ti.types.ndarray(dtype=vec2, ndim=1)
Matrices = ti.types.ndarray(dtype=mat2, ndim=1)
Momenta = ti.types.ndarray(dtype=vec3, ndim=2)
Fields = ti.types.ndarray(dtype=vec2, ndim=2)
Count = ti.types.ndarray(dtype=ti.i32, ndim=1)

AMPLITUDE, K, OMEGA, PAD = Axes.AMPLITUDE, Axes.K, Axes.OMEGA, Axes.PAD
PHASE_X, PHASE_Y = Axes.PHASES
LAME, SHEAR = Axes.LAME, Axes.SHEAR


@ti.func
def body_force(start, t):
    """By where a particle started."""
    swing = ti.Vector([ti.sin(OMEGA * t + PHASE_X), ti.sin(OMEGA * t + PHASE_Y)])
    u, f = vec2(0), vec2(0)
    for d in ti.static(range(2)):
        u[d] = AMPLITUDE * ti.sin(K * start[d]) * swing[d]
        f[d] = 1 + AMPLITUDE * K * ti.cos(K * start[d]) * swing[d]
    log_j = ti.log(f[0] * f[1])
    b = vec2(0)
    for d in ti.static(range(2)):
        b[d] = -OMEGA * OMEGA * u[d] + K * K * u[d] * (SHEAR + (LAME * (1 - log_j) + SHEAR) / (f[d] * f[d]))
    return b


@ti.func
def kirchhoff(deformation):
    """Kirchhoff stress, neo-Hookean: by the reference volume it is the Cauchy stress by the volume."""
    left = deformation @ deformation.transpose()
    return SHEAR * (left - ti.Matrix.identity(ti.f64, 2)) + LAME * ti.log(
        deformation.determinant()
    ) * ti.Matrix.identity(ti.f64, 2)


@ti.func
def hat(x, h):
    """First node, weights and slopes of both axes."""
    at = x / h + PAD
    base = ti.floor(at).cast(ti.i32)
    xi = at - base
    one = vec2(1)
    return base, ti.Matrix.cols([one - xi, xi]), ti.Matrix.cols([-one / h, one / h])


@ti.func
def quadratic(x, h):
    at = x / h + PAD
    base = ti.floor(at - 0.5).cast(ti.i32)
    xi = at - base - 1
    weights = ti.Matrix.cols([0.5 * (0.5 - xi) ** 2, 0.75 - xi**2, 0.5 * (0.5 + xi) ** 2])
    return base, weights, ti.Matrix.cols([(xi - 0.5) / h, -2 * xi / h, (xi + 0.5) / h])


@ti.func
def still(node, low, high, value):
    """No component across planes of symmetry."""
    for d in ti.static(range(2)):
        if node[d] == low or node[d] == high:
            value[d] = 0.0
    return value


@ti.func
def kept(x, start, h, lost: ti.template()):
    """Where a particle is; what would leave the box of nodes is counted and put back to its start, for the run is over."""
    at = x / h
    inside = True
    for d in ti.static(range(2)):
        # Written so that what is not a number is outside.
        inside = inside and at[d] > -1 and at[d] < ti.round(1 / h) + 1
    if not inside:
        lost[0] += 1
        x = start
    return x


@ti.kernel
def hats_flip_musl(
    starts: Vectors, x: Vectors, moved: Vectors, v: Vectors, deformation: Matrices, momentum: Momenta, force: Fields,
    again: Fields, lost: Count, first: int, end: int, dt: ti.f64, h: ti.f64, mass: ti.f64,
):
    low, high = PAD, momentum.shape[0] - 1 - PAD
    ti.loop_config(serialize=True)
    for n in range(first, end):
        for i, j in ti.ndrange(momentum.shape[0], momentum.shape[1]):
            momentum[i, j], force[i, j], again[i, j] = vec3(0), vec2(0), vec2(0)
        for p in range(x.shape[0]):
            base, w, g = hat(x[p], h)
            tau, b = kirchhoff(deformation[p]) * mass, body_force(starts[p], n * dt) * mass
            for i, j in ti.static(ti.ndrange(2, 2)):
                node = base + ti.Vector([i, j])
                weight = w[0, i] * w[1, j] * mass
                momentum[node] += vec3(weight * v[p][0], weight * v[p][1], weight)
                force[node] += w[0, i] * w[1, j] * b - tau @ vec2(g[0, i] * w[1, j], w[0, i] * g[1, j])
        for i, j in ti.ndrange(momentum.shape[0], momentum.shape[1]):
            m = momentum[i, j][2]
            if m > 0:
                node = ti.Vector([i, j])
                a = still(node, low, high, force[i, j] / m)
                old = still(node, low, high, vec2(momentum[i, j][0], momentum[i, j][1]) / m)
                momentum[i, j] = vec3(old[0] + dt * a[0], old[1] + dt * a[1], m)
                force[i, j] = a
        for p in range(x.shape[0]):
            base, w, _ = hat(x[p], h)
            nodal, rise = vec2(0), vec2(0)
            for i, j in ti.static(ti.ndrange(2, 2)):
                node = base + ti.Vector([i, j])
                nodal += w[0, i] * w[1, j] * vec2(momentum[node][0], momentum[node][1])
                rise += w[0, i] * w[1, j] * force[node]
            v[p] += dt * rise
            moved[p] = x[p] + dt * nodal
            for i, j in ti.static(ti.ndrange(2, 2)):
                again[base + ti.Vector([i, j])] += w[0, i] * w[1, j] * mass * v[p]
        for i, j in ti.ndrange(momentum.shape[0], momentum.shape[1]):
            m = momentum[i, j][2]
            if m > 0:
                again[i, j] = still(ti.Vector([i, j]), low, high, again[i, j] / m)
        for p in range(x.shape[0]):
            base, w, g = hat(x[p], h)
            gradient = mat2(0)
            for i, j in ti.static(ti.ndrange(2, 2)):
                gradient += again[base + ti.Vector([i, j])].outer_product(
                    vec2(g[0, i] * w[1, j], w[0, i] * g[1, j])
                )
            deformation[p] += dt * gradient @ deformation[p]
            x[p] = kept(moved[p], starts[p], h, lost)


@ti.func
def mirror(momentum: ti.template(), force: ti.template(), low, high):
    """What splines map behind planes of symmetry is added, mirrored, to the nodes in front, of which those behind become
    the images: first all of the one, then all of the other, for the sake of corners."""
    for copies, axis in ti.static(ti.ndrange(2, 2)):
        sign = vec2(1)
        sign[axis] = -1
        for k in range(momentum.shape[0]):
            for side in ti.static([1, -1]):
                front, back = ti.Vector([k, k]), ti.Vector([k, k])
                front[axis] = (low if ti.static(side > 0) else high) + side
                back[axis] = front[axis] - 2 * side
                image = vec3(sign[0], sign[1], 1)
                if ti.static(copies):
                    momentum[back], force[back] = momentum[front] * image, force[front] * sign
                else:
                    momentum[front] += momentum[back] * image
                    force[front] += force[back] * sign


@ti.kernel
def splines_apic_usl(
    starts: Vectors, x: Vectors, v: Vectors, affine: Matrices, deformation: Matrices, momentum: Momenta, force: Fields,
    lost: Count, first: int, end: int, dt: ti.f64, h: ti.f64, mass: ti.f64,
):
    low, high = PAD, momentum.shape[0] - 1 - PAD
    ti.loop_config(serialize=True)
    for n in range(first, end):
        for i, j in ti.ndrange(momentum.shape[0], momentum.shape[1]):
            momentum[i, j], force[i, j] = vec3(0), vec2(0)
        for p in range(x.shape[0]):
            base, w, g = quadratic(x[p], h)
            tau, b = kirchhoff(deformation[p]) * mass, body_force(starts[p], n * dt) * mass
            for i, j in ti.static(ti.ndrange(3, 3)):
                node = base + ti.Vector([i, j])
                weight = w[0, i] * w[1, j] * mass
                there = v[p] + affine[p] @ ((node - PAD) * h - x[p])
                momentum[node] += vec3(weight * there[0], weight * there[1], weight)
                force[node] += w[0, i] * w[1, j] * b - tau @ vec2(g[0, i] * w[1, j], w[0, i] * g[1, j])
        mirror(momentum, force, low, high)
        for i, j in ti.ndrange(momentum.shape[0], momentum.shape[1]):
            m = momentum[i, j][2]
            if m > 0:
                new = (vec2(momentum[i, j][0], momentum[i, j][1]) + dt * force[i, j]) / m
                new = still(ti.Vector([i, j]), low, high, new)
                momentum[i, j] = vec3(new[0], new[1], m)
        for p in range(x.shape[0]):
            base, w, g = quadratic(x[p], h)
            nodal, moment, gradient = vec2(0), mat2(0), mat2(0)
            for i, j in ti.static(ti.ndrange(3, 3)):
                node = base + ti.Vector([i, j])
                weight = w[0, i] * w[1, j]
                velocity = vec2(momentum[node][0], momentum[node][1])
                nodal += weight * velocity
                moment += (weight * velocity).outer_product((node - PAD) * h - x[p])
                gradient += velocity.outer_product(vec2(g[0, i] * w[1, j], w[0, i] * g[1, j]))
            v[p] = nodal
            affine[p] = moment * (4 / (h * h))
            deformation[p] += dt * gradient @ deformation[p]
            x[p] = kept(x[p] + dt * nodal, starts[p], h, lost)


def vectors(values):
    made = ti.ndarray(vec2, len(values))
    made.from_numpy(np.ascontiguousarray(values))
    return made


def matrices(scene, diagonal):
    made = ti.ndarray(mat2, len(scene))
    made.from_numpy(np.tile(diagonal * np.eye(2), (len(scene), 1, 1)))
    return made


def particles(scene):
    """Starts, positions, velocities, deformation gradients; and what returns the last three, and how many are lost."""
    starts, x, v = (vectors(a) for a in (scene.starts, scene.starts, scene.velocities))
    deformation = matrices(scene, 1.0)
    lost = ti.ndarray(ti.i32, 1)
    state = lambda: (x.to_numpy(), v.to_numpy(), deformation.to_numpy(), lost.to_numpy()[0])
    return starts, x, v, deformation, lost, state


def grid(scene, kind):
    return ti.ndarray(kind, (scene.nodes, scene.nodes))


def with_hats(scene):
    starts, x, v, deformation, lost, state = particles(scene)
    moved = ti.ndarray(vec2, len(scene))
    nodes = [grid(scene, kind) for kind in (vec3, vec2, vec2)]

    def advance(first, end):
        hats_flip_musl(starts, x, moved, v, deformation, *nodes, lost, first, end, scene.dt, scene.h, scene.mass)
        ti.sync()

    return advance, state


def with_splines(scene):
    starts, x, v, deformation, lost, state = particles(scene)
    affine = matrices(scene, 0.0)
    nodes = [grid(scene, kind) for kind in (vec3, vec2)]

    def advance(first, end):
        splines_apic_usl(starts, x, v, affine, deformation, *nodes, lost, first, end, scene.dt, scene.h, scene.mass)
        ti.sync()

    return advance, state


scenes.run_axes(
    "Taichi " + ".".join(map(str, ti.__version__)),
    {"linear FLIP-MUSL": with_hats, "quadratic APIC": with_splines},
)
