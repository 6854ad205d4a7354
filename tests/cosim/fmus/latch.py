"""y keeps what u was when initialization ended: right only if u was consistent by then."""

from xml.etree.ElementTree import SubElement

from pythonfmu import Fmi2Causality, Fmi2Initial, Fmi2Slave, Real


class Latch(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u = 0.0
        self.kept = None
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(
            Real(
                "y",
                causality=Fmi2Causality.output,
                initial=Fmi2Initial.calculated,
                getter=lambda: self.u if self.kept is None else self.kept,
                setter=lambda value: None,
            )
        )

    def to_xml(self, model_options=None):
        root = super().to_xml(model_options or {})
        structure = root.find("ModelStructure")
        for unknown in structure.find("Outputs"):
            unknown.set("dependencies", "")
        initial = SubElement(structure, "InitialUnknowns")
        SubElement(initial, "Unknown", {"index": "2", "dependencies": "1"})
        return root

    def exit_initialization_mode(self):
        self.kept = self.u

    def do_step(self, current_time, step_size):
        return True


# PythonFMU 0.7.0's wrapper executes this module anew for each instance and then releases a
# reference to its namespace that is not its own: without another one that is freed while in use.
globals().setdefault("_held", []).append(globals())
