"""A level of an enumeration and its number: mode in, chosen and y out; both directly.

`scale` multiplies y; `calibrated` is a parameter that initialization calculates, twice it.
"""

from xml.etree.ElementTree import SubElement

from pythonfmu import Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability, Integer, Real


class Switch(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.mode = 1
        self.scale = 1.0
        discrete = {"variability": Fmi2Variability.discrete}
        out = {"causality": Fmi2Causality.output, "initial": Fmi2Initial.calculated}
        self.register_variable(Integer("mode", causality=Fmi2Causality.input, **discrete))
        self.register_variable(Integer("chosen", getter=lambda: self.mode, **out, **discrete))
        self.register_variable(
            Real("y", getter=lambda: self.scale * self.mode, setter=lambda v: None, **out)
        )
        fixed = {"variability": Fmi2Variability.fixed}
        self.register_variable(
            Real("scale", causality=Fmi2Causality.parameter, initial=Fmi2Initial.exact, **fixed)
        )
        self.register_variable(
            Real(
                "calibrated",
                causality=Fmi2Causality.calculatedParameter,
                initial=Fmi2Initial.calculated,
                getter=lambda: 2.0 * self.scale,
                setter=lambda v: None,
                **fixed,
            )
        )

    def to_xml(self, model_options=None):
        root = super().to_xml(model_options or {})
        variables = root.find("ModelVariables")
        for variable in variables:
            if variable.get("name") in ("mode", "chosen"):
                typed = variable.find("Integer")
                typed.tag = "Enumeration"
                typed.set("declaredType", "Mode")
            if variable.get("name") == "scale":
                variable.find("Real").set("unit", "m")
        units = SubElement(root, "UnitDefinitions")
        SubElement(SubElement(units, "Unit", {"name": "m"}), "BaseUnit", {"m": "1"})
        types = SubElement(root, "TypeDefinitions")
        items = SubElement(SubElement(types, "SimpleType", {"name": "Mode"}), "Enumeration")
        for name, value in (("off", "1"), ("low", "3"), ("high", "7")):
            SubElement(items, "Item", {"name": name, "value": value})
        for place, element in enumerate((units, types), 1):
            root.remove(element)
            root.insert(place, element)
        return root

    def do_step(self, current_time, step_size):
        return True


# PythonFMU 0.7.0's wrapper executes this module anew for each instance and then releases a
# reference to its namespace that is not its own: without another one that is freed while in use.
globals().setdefault("_held", []).append(globals())
