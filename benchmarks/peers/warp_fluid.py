"""Cube of incompressible water that falls, by Warp's example of an APIC fluid (velocities at nodes, pressure in cells; on the processor one thread).

Prints an object with particles, steps and processor seconds, compilation left out.
usage: warp_fluid.py --cells N --steps N       N cells along the edge of the cube, 8 particles a cell
"""
import argparse
import json
import time


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--cells", type=int, required=True)
    options.add_argument("--steps", type=int, required=True)
    options = options.parse_args()
    try:
        import warp
        from warp.examples.fem.example_apic_fluid import Example
    except ImportError:
        raise SystemExit("no Warp with its examples here: pip install warp-lang numpy")
    warp.config.quiet = True
    warp.set_module_options({"enable_backward": False})
    with warp.ScopedDevice("cpu"):
        fluid = Example(quiet=True, stage_path=None, voxel_size=10.0 / options.cells)
        for _ in range(2):
            fluid.step()
        start = time.process_time()
        for _ in range(options.steps):
            fluid.step()
        seconds = time.process_time() - start
    print(json.dumps({"particles": fluid.state_0.particle_q.shape[0], "steps": options.steps, "seconds": seconds}))


main()
