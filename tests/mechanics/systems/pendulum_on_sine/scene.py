import math

from curvebound.cosim import Scene

needs = {"plant.bob.x": 1e-6, "plant.bob.y": 1e-6}
scene = Scene("swung", stop_time=5.0, step=0.05, needs=needs)
scene.add("plant", ".", {"pivot.damping": 0.2, "rod.damping": 0.1, "solver.method": "adaptive"})
scene.input("plant.wire.ax", lambda t: math.sin(4.0 * t))
scene.input("plant.bob.fy", lambda t: math.cos(2.0 * t))
scene.record("plant.*")
