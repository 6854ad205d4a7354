"""A study: every setting of the grid run, judged, timed, and kept as soon as it is known."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...cosim.system import port_of
from ...files import append, write_whole
from ..grid import Family, grid, is_sampled
from ..identity import identity
from ..reference.reference_set import ReferenceSet
from ..runner import Outcome, Runner
from ..settings import Setting, Space, space_of, study_outputs
from .amplitudes import amplitude_rows
from .repeated_timing import time_again

if TYPE_CHECKING:
    from ...cosim.scene import Scene
    from ...cosim.system import System

__all__ = ["Row", "Study"]

Row = dict[str, Any]
#: told (settings done, settings in all, label of the present one)
Progress = Callable[[int, int, str], None]

_FLOOR = 3e-15  # errors below this are rounding: finer settings cannot show more


@dataclass
class Study:
    """The rows of one scene. `references` says how each model was solved, and how surely."""

    scene: Scene
    system: System
    space: Space
    paths: list[str]
    quick: bool
    limit: float
    rows: list[Row] = field(default_factory=list)
    references: list[Row] = field(default_factory=list)
    complete: bool = False

    @classmethod
    def of(
        cls,
        scene: Scene,
        *,
        quick: bool = False,
        limit: float = 2.0,
        outputs: Sequence[str] | None = None,
    ) -> Study:
        """A study that has not begun.

        quick: a thinner grid; limit: CPU seconds that one run may take; outputs: paths to judge
        instead of those that the scene needs.
        """
        system = scene.check()
        space = space_of(system)
        paths = list(outputs) if outputs else study_outputs(scene, system)
        return cls(scene, system, space, paths, quick, limit)

    @property
    def unit(self) -> str:
        """The unit of the errors: those of the outputs, where they have several."""
        return ", ".join(dict.fromkeys(self.system.units(map(port_of, self.paths)).values()))

    def run(self, journal: Path | None = None, progress: Progress | None = None) -> None:
        """Run what is not yet in the journal; KeyboardInterrupt leaves what is done in `rows`."""
        known = self._open(journal)
        families = list(grid(self.scene, self.space, quick=self.quick))
        count = sum(len(family.settings) for family in families)
        references = ReferenceSet(self.system, self.space.best_model, self.paths)
        sampled = is_sampled(self.scene, self.space)
        continuous = (
            ReferenceSet(self.system, self.space.best_model, self.paths, continuous=True)
            if sampled
            else None
        )
        if progress is not None:
            progress(0, count, "references")
        self.references = [_described(references, self.space.best_model, "scene")]
        done = 0
        settings: dict[str, Setting] = {}
        with Runner(self.scene, self.space, self.paths) as runner:
            for family in families:
                done_before = done
                before: Row | None = None
                for setting in family.settings:
                    if progress is not None:
                        progress(done, count, setting.label)
                    key = f"{family.purpose}|{setting.key}"
                    row = known.get(key)
                    if row is None:
                        if before is not None and self._hopeless(family, setting, before):
                            break
                        row = self._row(family, setting, runner, references, continuous)
                        row["key"] = key
                        _append(journal, row)
                    self.rows.append(row)
                    settings[key] = setting
                    before = row
                    done += 1
                done = done_before + len(family.settings)
            if progress is not None:
                progress(done, count, "the cheapest again")
            for row in time_again(self.rows, settings, runner):
                _append(journal, row)
            if progress is not None:
                progress(done, count, "smaller motions")
            for row in amplitude_rows(runner, known):
                if row["key"] not in known:
                    _append(journal, row)
                self.rows.append(row)
        for structure, simpler in zip(self.space.structures, self.space.approximate, strict=True):
            if simpler:
                model = self.space.model(Setting(structure, "", None, 1.0, ""))
                self.references.append(_described(references, model, "simpler model"))
        if continuous is not None:
            self.references.append(_described(continuous, self.space.best_model, "continuous"))
        self.complete = True
        if progress is not None:
            progress(count, count, "done")

    # one row

    def _hopeless(self, family: Family, setting: Setting, before: Row) -> bool:
        """Whether a finer setting would cost too much, or show nothing new."""
        if family.purpose == "micro" and 0.0 <= before["numerical"] < _FLOOR:
            return True
        ratio = 1.0
        if setting.size and before["size"] and not setting.by_tolerance:
            ratio = before["size"] / setting.size
        ratio = max(ratio, before["macro_step"] / setting.step)
        span = self.scene.stop_time - self.scene.start_time
        return bool(before["cpu"] * ratio * span > self.limit)

    def _row(
        self,
        family: Family,
        setting: Setting,
        runner: Runner,
        references: ReferenceSet,
        continuous: ReferenceSet | None,
    ) -> Row:
        outcome = runner.run(setting)
        row: Row = {
            "purpose": family.purpose,
            "form": setting.form,
            "method": setting.method,
            "size_is": None if setting.size is None else (
                "tolerance" if setting.by_tolerance else "step"
            ),
            "size": setting.size,
            "macro_step": setting.step,
            "algorithm": setting.algorithm,
            "hold": setting.hold,
            "coupling": setting.coupling,
            "cpu": outcome.cpu,
            "steps": outcome.counts.get("solver.steps", 0),
            "evaluations": outcome.counts.get("solver.evaluations", 0),
            "energy_residual": outcome.measures.get("energy.residual"),
            "drift": outcome.measures.get("constraint.drift"),
            "acceleration_error": outcome.measures.get("model.acceleration_error"),
            "kinetic": outcome.measures.get("energy.kinetic"),
            "failure": outcome.failure,
        }  # fmt: skip
        if outcome.failure or len(outcome.times) < 2:
            row |= {"error": math.inf, "numerical": math.inf, "judged": False, "judged_until": None}
            row["failure"] = outcome.failure or "nothing was recorded"
            return row
        row["cpu"] = runner.cost(setting, runs=1, enough=3e-3)  # what may matter is timed again
        row |= self._errors(setting, outcome, references)
        if continuous is not None and family.purpose == "macro":
            verdicts = continuous.errors(outcome.times, outcome.outputs)
            row["from_continuous"] = max(v.worst for v in verdicts.values())
        return row

    def _errors(self, setting: Setting, outcome: Outcome, references: ReferenceSet) -> Row:
        """Errors of each output: total, numerical and of the model."""
        times = outcome.times
        total = references.errors(times, outcome.outputs)
        own = total
        row: Row = {}
        if self.space.is_approximate(setting):
            own = references.errors(times, outcome.outputs, model=self.space.model(setting))
            model = references.modelling(self.space.model(setting), times)
            row["modelling"] = max(v.worst for v in model.values())
            row |= {f"modelling.worst.{path}": v.worst for path, v in model.items()}
            row |= {f"modelling.final.{path}": v.final for path, v in model.items()}
        else:
            row["modelling"] = 0.0
        for kind, verdicts in (("total", total), ("numerical", own)):
            row |= {f"{kind}.worst.{path}": v.worst for path, v in verdicts.items()}
            row |= {f"{kind}.final.{path}": v.final for path, v in verdicts.items()}
        exact = references.values(self.space.best_model, times)
        sizes = {path: float(np.ptp(exact[path][:, 0])) for path in self.paths}
        row |= {f"amplitude.{path}": size for path, size in sizes.items()}
        row["amplitude"] = max(sizes.values())
        row["error"] = max(v.worst for v in total.values())
        row["numerical"] = max(v.worst for v in own.values())
        row["judged"] = all(v.judged for v in own.values())
        row["judged_until"] = min(v.until for v in own.values())
        return row

    # resuming

    def _open(self, journal: Path | None) -> dict[str, Row]:
        """Rows of an interrupted study of the same thing; a journal of another one begins anew."""
        if journal is None:
            return {}
        word = identity(self.system, quick=self.quick, paths=self.paths)
        rows: dict[str, Row] = {}
        with suppress(Exception):  # not there, or no journal of a study
            lines = journal.read_text(encoding="utf-8").splitlines()
            if json.loads(lines[0])["identity"] == word:
                for line in lines[1:]:
                    with suppress(Exception):  # the last line of a process that was killed
                        row = json.loads(line)
                        rows[row["key"]] = row
        if not rows:
            first = json.dumps({"identity": word}) + "\n"
            write_whole(journal, lambda path: path.write_text(first, encoding="utf-8"))
        return rows


def _append(journal: Path | None, row: Row) -> None:
    if journal is not None:
        append(journal, json.dumps(row) + "\n")


def _described(references: ReferenceSet, model: dict[str, str], what: str) -> Row:
    reference = references.of_model(model)
    stop = references.system.scene.stop_time
    doubt = {path: float(reference.uncertainty(path, [stop])[0, 0]) for path in references.paths}
    return {"what": what, "model": model, "how": reference.how, "uncertainty": doubt}
