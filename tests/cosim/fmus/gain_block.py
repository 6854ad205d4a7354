"""y = gain u + bias: nothing but direct feedthrough, and an integer and a Boolean twin.

Fails at `fail_time` in the way that `failure` says: 1 an error, 2 an exception; 3 ends there.
"""

from xml.etree.ElementTree import SubElement

from pythonfmu import Boolean, Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability, Integer, Real


class GainBlock(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u = 0.0
        self.count_in = 0
        self.flag_in = False
        self.gain = 1.0
        self.bias = 0.0
        self.tuned = 0.0
        self.fail_time = 1e300
        self.failure = 1
        self.square = False
        self.label = "none"
        fixed = {
            "causality": Fmi2Causality.parameter,
            "variability": Fmi2Variability.fixed,
            "initial": Fmi2Initial.exact,
        }
        calculated = {"causality": Fmi2Causality.output, "initial": Fmi2Initial.calculated}
        discrete = {"variability": Fmi2Variability.discrete}
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(
            Real("y", getter=lambda: self.output(), setter=lambda v: None, **calculated)
        )
        self.register_variable(Real("gain", **fixed))
        self.register_variable(Real("bias", **fixed))
        self.register_variable(Real("tuned", **{**fixed, "variability": Fmi2Variability.tunable}))
        self.register_variable(Real("fail_time", **fixed))
        self.register_variable(Integer("failure", **fixed))
        self.register_variable(Boolean("square", **fixed))
        self.register_variable(Integer("count_in", causality=Fmi2Causality.input, **discrete))
        self.register_variable(
            Integer("count", getter=lambda: self.count_in + 1, **calculated, **discrete)
        )
        self.register_variable(Boolean("flag_in", causality=Fmi2Causality.input, **discrete))
        self.register_variable(
            Boolean("flag", getter=lambda: not self.flag_in, **calculated, **discrete)
        )

    def output(self):
        u = self.u * self.u if self.square else self.u
        return self.gain * u + self.bias + self.tuned

    def to_xml(self, model_options=None):
        root = super().to_xml(model_options or {})
        names = [v.get("name") for v in root.find("ModelVariables")]
        index = {name: str(names.index(name) + 1) for name in names}
        inputs = {"y": "u", "count": "count_in", "flag": "flag_in"}
        structure = root.find("ModelStructure")
        for unknown in structure.find("Outputs"):
            output = names[int(unknown.get("index")) - 1]
            unknown.set("dependencies", index[inputs[output]])
        initial = SubElement(structure, "InitialUnknowns")
        for output in inputs:
            SubElement(
                initial, "Unknown", {"index": index[output], "dependencies": index[inputs[output]]}
            )
        units = SubElement(root, "UnitDefinitions")
        root.remove(units)
        root.insert(1, units)
        for name, base in (("m", {"m": "1"}), ("km", {"m": "1", "factor": "1000"})):
            SubElement(SubElement(units, "Unit", {"name": name}), "BaseUnit", base)
        for variable in root.find("ModelVariables"):
            if variable.get("name") in ("u", "y"):
                variable.find("Real").set("unit", "m" if variable.get("name") == "u" else "km")
        return root

    def do_step(self, current_time, step_size):
        if current_time + step_size > self.fail_time:
            if self.failure == 2:
                raise RuntimeError("the gain block was told to fail")
            if self.failure == 1:
                self.log("the gain block was told to fail", status=self._discard())
            return False
        return True

    @staticmethod
    def _discard():
        from pythonfmu.enums import Fmi2Status

        return Fmi2Status.error


# PythonFMU 0.7.0's wrapper executes this module anew for each instance and then releases a
# reference to its namespace that is not its own: without another one that is freed while in use.
globals().setdefault("_held", []).append(globals())
