"""Throughput of Taichi on the processor: elastic particles (`scenes.blocks`, `scenes.cube`), written from scratch for this project.

schemes:  musl  linear hats, MUSL, Jaumann linear elastic (two scatters, two gathers)
          mls   quadratic B-splines, APIC/MLS-MPM, neo-Hookean
usage: taichi_throughput.py --help
"""
import math

import numpy as np
import taichi as ti

import scenes

options = scenes.throughput_options(threads=True)
scheme, scene = options.scheme, options.scene
R = ti.f64 if options.precision == "f64" else ti.f32
ti.init(arch=ti.cpu, cpu_max_num_threads=options.threads, default_fp=R, fast_math=True, log_level=ti.ERROR)

NX, NY, NZ = scene.nodes
lam, mu, dt = scene.lame, scene.shear, scene.dt
off = 1.0 if scheme == "mls" else 0.0
N = len(scene)
m = V0 = 0.125
vec3 = ti.types.vector(3, R)
# Every thread has nodes of its own to add to, which are summed later: atomic additions take several times as long.
T = options.threads
# Taichi gives a thread no fewer turns of a loop than this.
LEAST = 512
memory = 0


def field(components, shape):
    """A field of numbers, vectors or matrices, whose bytes are counted."""
    global memory
    memory += math.prod(components) * math.prod(np.atleast_1d(shape)) * (8 if R == ti.f64 else 4)
    if len(components) == 2:
        return ti.Matrix.field(*components, R, shape)
    return ti.Vector.field(*components, R, shape) if components else ti.field(R, shape)


x = field((3,), N)
v = field((3,), N)
g = field((4,), (T, *scene.nodes))      # momentum (3), mass; of all threads in the first
if scheme == "mls":
    F = field((3, 3), N)
    C = field((3, 3), N)
else:
    f = field((3,), (T, *scene.nodes))  # internal force / acceleration
    s = field((6,), N)              # stress xx yy zz yz xz xy
    vol = field((), N)


@ti.func
def first(share):
    """The first particle of a turn."""
    return ti.cast(share * ti.cast(N, ti.i64) // (T * LEAST), ti.i32)


@ti.func
def of(t, I):
    """A node of a thread's own; sums and what follows from them stand in those of the first."""
    return ti.Vector([t, I[0], I[1], I[2]])


@ti.func
def add(sums: ti.template(), t, I, value):
    """Plainly: `+=` would be atomic."""
    sums[of(t, I)] = sums[of(t, I)] + value


@ti.func
def total(sums: ti.template(), I):
    all_ = sums[of(0, I)]
    for t in ti.static(range(1, T)):
        all_ = all_ + sums[of(t, I)]
    return all_


@ti.kernel
def clear():
    for I in ti.grouped(g):
        g[I] = ti.Vector.zero(R, 4)
        f[I] = ti.Vector.zero(R, 3)


# ---------------------------------------------------------------- linear hats
@ti.kernel
def p2g_hat():
    for share in range(T * LEAST):
        t = share // LEAST
        for p in range(first(share), first(share + 1)):
            b = ti.floor(x[p]).cast(int)
            d = x[p] - b
            w = ti.Matrix.cols([1 - d, d])
            sg, vp, vo = s[p], v[p] * m, vol[p]
            for i, j, k in ti.static(ti.ndrange(2, 2, 2)):
                N_ = w[0, i] * w[1, j] * w[2, k]
                G = vec3((2 * i - 1) * w[1, j] * w[2, k], (2 * j - 1) * w[0, i] * w[2, k], (2 * k - 1) * w[0, i] * w[1, j]) * vo
                I = b + ti.Vector([i, j, k])
                add(g, t, I, ti.Vector([N_ * vp[0], N_ * vp[1], N_ * vp[2], N_ * m]))
                add(f, t, I, -vec3(sg[0] * G[0] + sg[5] * G[1] + sg[4] * G[2],
                                   sg[5] * G[0] + sg[1] * G[1] + sg[3] * G[2],
                                   sg[4] * G[0] + sg[3] * G[1] + sg[2] * G[2]))


@ti.kernel
def grid_hat():
    for I in ti.grouped(ti.ndrange(NX, NY, NZ)):
        momentum = total(g, I)
        mm = momentum[3]
        if mm > 1e-5:
            a = total(f, I) / mm
            vel = vec3(momentum[0], momentum[1], momentum[2]) / mm + a * dt
            g[of(0, I)] = ti.Vector([vel[0], vel[1], vel[2], mm])
            f[of(0, I)] = a


@ti.func
def stress(p, L):
    # L[r][c] = dv_r/dx_c ; Jaumann rate, linear elastic
    d = vec3(L[0, 0], L[1, 1], L[2, 2]) * dt
    tr = d[0] + d[1] + d[2]
    gyz, gxz, gxy = (L[1, 2] + L[2, 1]) * dt, (L[0, 2] + L[2, 0]) * dt, (L[0, 1] + L[1, 0]) * dt
    wz, wy, wx = 0.5 * (L[1, 0] - L[0, 1]) * dt, 0.5 * (L[0, 2] - L[2, 0]) * dt, 0.5 * (L[2, 1] - L[1, 2]) * dt
    o = s[p]
    n = ti.Vector.zero(R, 6)
    n[0] = o[0] + 2 * (wy * o[4] - wz * o[5]) + lam * tr + 2 * mu * d[0]
    n[1] = o[1] + 2 * (wz * o[5] - wx * o[3]) + lam * tr + 2 * mu * d[1]
    n[2] = o[2] + 2 * (wx * o[3] - wy * o[4]) + lam * tr + 2 * mu * d[2]
    n[3] = o[3] + wx * (o[1] - o[2]) + wz * o[4] - wy * o[5] + mu * gyz
    n[4] = o[4] + wy * (o[2] - o[0]) + wx * o[5] - wz * o[3] + mu * gxz
    n[5] = o[5] + wz * (o[0] - o[1]) + wy * o[3] - wx * o[4] + mu * gxy
    s[p] = n
    vol[p] *= 1 + tr


@ti.kernel
def zero_mom():
    for I in ti.grouped(v2):
        v2[I] = ti.Vector.zero(R, 3)


@ti.kernel
def g2p_musl_a():                       # velocity, keep old position for the shapes; second scatter
    for share in range(T * LEAST):
        t = share // LEAST
        for p in range(first(share), first(share + 1)):
            b = ti.floor(x[p]).cast(int)
            d = x[p] - b
            w = ti.Matrix.cols([1 - d, d])
            vn, an = ti.Vector.zero(R, 3), ti.Vector.zero(R, 3)
            for i, j, k in ti.static(ti.ndrange(2, 2, 2)):
                N_ = w[0, i] * w[1, j] * w[2, k]
                I = of(0, b + ti.Vector([i, j, k]))
                vn += N_ * vec3(g[I][0], g[I][1], g[I][2])
                an += N_ * f[I]
            vp = v[p] + an * dt
            v[p] = vp
            xn[p] = x[p] + vn * dt
            for i, j, k in ti.static(ti.ndrange(2, 2, 2)):
                N_ = w[0, i] * w[1, j] * w[2, k] * m
                add(v2, t, b + ti.Vector([i, j, k]), N_ * vp)


@ti.kernel
def grid_musl():
    for I in ti.grouped(ti.ndrange(NX, NY, NZ)):
        mm = g[of(0, I)][3]
        if mm > 1e-5:
            v2[of(0, I)] = total(v2, I) / mm


@ti.kernel
def g2p_musl_b():
    for p in x:
        b = ti.floor(x[p]).cast(int)
        d = x[p] - b
        w = ti.Matrix.cols([1 - d, d])
        L = ti.Matrix.zero(R, 3, 3)
        for i, j, k in ti.static(ti.ndrange(2, 2, 2)):
            G = vec3((2 * i - 1) * w[1, j] * w[2, k], (2 * j - 1) * w[0, i] * w[2, k], (2 * k - 1) * w[0, i] * w[1, j])
            L += v2[of(0, b + ti.Vector([i, j, k]))].outer_product(G)
        x[p] = xn[p]
        stress(p, L)


# ---------------------------------------------------------------- MLS-MPM, quadratic
@ti.kernel
def p2g_mls():
    for share in range(T * LEAST):
        t = share // LEAST
        for p in range(first(share), first(share + 1)):
            b = (x[p] + off - 0.5).cast(int)
            d = x[p] + off - b
            w = ti.Matrix.cols([0.5 * (1.5 - d) ** 2, 0.75 - (d - 1) ** 2, 0.5 * (d - 0.5) ** 2])
            Fp = F[p] + dt * C[p] @ F[p]
            F[p] = Fp
            J = Fp.determinant()
            tau = mu * (Fp @ Fp.transpose() - ti.Matrix.identity(R, 3)) + lam * ti.log(J) * ti.Matrix.identity(R, 3)
            A = (-dt * V0 * 4.0) * tau + m * C[p]
            mv = m * v[p]
            for i, j, k in ti.static(ti.ndrange(3, 3, 3)):
                dp = vec3(i, j, k) - d
                W = w[0, i] * w[1, j] * w[2, k]
                q = W * (mv + A @ dp)
                add(g, t, b + ti.Vector([i, j, k]), ti.Vector([q[0], q[1], q[2], W * m]))


@ti.kernel
def grid_mls():
    for I in ti.grouped(ti.ndrange(NX, NY, NZ)):
        momentum = total(g, I)
        mm = momentum[3]
        if mm > 0:
            g[of(0, I)] = ti.Vector([momentum[0] / mm, momentum[1] / mm, momentum[2] / mm, mm])


@ti.kernel
def g2p_mls():
    for p in x:
        b = (x[p] + off - 0.5).cast(int)
        d = x[p] + off - b
        w = ti.Matrix.cols([0.5 * (1.5 - d) ** 2, 0.75 - (d - 1) ** 2, 0.5 * (d - 0.5) ** 2])
        nv, nC = ti.Vector.zero(R, 3), ti.Matrix.zero(R, 3, 3)
        for i, j, k in ti.static(ti.ndrange(3, 3, 3)):
            dp = vec3(i, j, k) - d
            W = w[0, i] * w[1, j] * w[2, k]
            I = of(0, b + ti.Vector([i, j, k]))
            gv = vec3(g[I][0], g[I][1], g[I][2])
            nv += W * gv
            nC += (4 * W) * gv.outer_product(dp)
        v[p], C[p] = nv, nC
        x[p] += dt * nv


@ti.kernel
def clear_g():
    for I in ti.grouped(g):
        g[I] = ti.Vector.zero(R, 4)


if scheme == "musl":
    xn = field((3,), N)
    v2 = field((3,), (T, *scene.nodes))

    def step():
        clear(); zero_mom(); p2g_hat(); grid_hat(); g2p_musl_a(); grid_musl(); g2p_musl_b()
else:
    def step():
        clear_g(); p2g_mls(); grid_mls(); g2p_mls()


@ti.kernel
def undeform():
    for p in F:
        F[p] = ti.Matrix.identity(R, 3)


def start():
    kind = np.float64 if R == ti.f64 else np.float32
    x.from_numpy(scene.positions.astype(kind, copy=False))
    v.from_numpy(scene.velocities.astype(kind, copy=False))
    if scheme == "mls":
        undeform()
        C.fill(0)
    else:
        vol.fill(V0)
        s.fill(0)


program = "Taichi " + ".".join(map(str, ti.__version__))
scenes.measure(options, program, start, step, ti.sync, memory, v.to_numpy)
