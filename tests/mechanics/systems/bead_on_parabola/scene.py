import math

from curvebound.cosim import Scene

scene = Scene("pushed", stop_time=10.0, step=0.05, needs={"wire.bead.x": 1e-6})
scene.add("wire", ".", {"bead.damping": 0.2, "solver.method": "adaptive"})
scene.input("wire.bead.fx", lambda t: 2.0 * math.sin(3.0 * t))
scene.record("wire.*")
