"""A mass between a wall spring and a coupling spring whose other end is prescribed.

m x'' = -k x - kc (x - other), integrated exactly while `other` is held, so that every error of a
coupled run is the master's. Outputs are functions of the state alone.
"""

import math

from pythonfmu import Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability, Real


class CoupledMass(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.x = 0.0
        self.v = 0.0
        self.energy = 0.0
        self.other = 0.0
        self.m = 1.0
        self.k = 1.0
        self.kc = 1.0
        self.x_start = 0.0
        self.v_start = 0.0
        for name in ("x", "v"):
            self.register_variable(
                Real(name, causality=Fmi2Causality.output, initial=Fmi2Initial.calculated)
            )
        self.register_variable(Real("other", causality=Fmi2Causality.input))
        for name in ("m", "k", "kc", "x_start", "v_start"):
            self.register_variable(
                Real(
                    name,
                    causality=Fmi2Causality.parameter,
                    variability=Fmi2Variability.fixed,
                    initial=Fmi2Initial.exact,
                )
            )

    def to_xml(self, model_options=None):
        root = super().to_xml(model_options or {})
        structure = root.find("ModelStructure")
        for unknown in structure.find("Outputs"):
            unknown.set("dependencies", "")
        return root

    def exit_initialization_mode(self):
        self.x = self.x_start
        self.v = self.v_start

    def enter_initialization_mode(self):
        self.x = self.x_start
        self.v = self.v_start

    def do_step(self, current_time, step_size):
        stiffness = self.k + self.kc
        rest = self.kc * self.other / stiffness
        omega = math.sqrt(stiffness / self.m)
        c, s = math.cos(omega * step_size), math.sin(omega * step_size)
        x, v = self.x - rest, self.v
        self.x = rest + c * x + s / omega * v
        self.v = c * v - omega * s * x
        return True


# PythonFMU 0.7.0's wrapper executes this module anew for each instance and then releases a
# reference to its namespace that is not its own: without another one that is freed while in use.
globals().setdefault("_held", []).append(globals())
