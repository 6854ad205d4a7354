"""Small FMUs built by pythonfmu itself, to test the masters apart from the project's own FMUs."""

from __future__ import annotations

from pathlib import Path

import pytest
from pythonfmu import FmuBuilder

from curvebound.cosim import Scene

SOURCES = Path(__file__).parent / "fmus"


def _build(name: str, folder: Path, **options: object) -> Path:
    return Path(
        FmuBuilder.build_FMU(SOURCES / f"{name}.py", dest=folder, **options)  # type: ignore[arg-type]
    )


@pytest.fixture(scope="session")
def build_fmu(tmp_path_factory: pytest.TempPathFactory):
    """A function that builds one of the small FMUs by its file's name."""
    return lambda name, **options: _build(
        name, tmp_path_factory.mktemp(name), needsExecutionTool=False, **options
    )


@pytest.fixture(scope="session")
def mass_fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _build(
        "coupled_mass",
        tmp_path_factory.mktemp("mass"),
        canGetAndSetFMUstate=True,
        canSerializeFMUstate=True,
        needsExecutionTool=False,
    )


@pytest.fixture(scope="session")
def gain_fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _build("gain_block", tmp_path_factory.mktemp("gain"), needsExecutionTool=False)


@pytest.fixture
def two_masses(mass_fmu: Path):
    """A function that makes the scene of two masses coupled by their positions."""

    def make(
        k: tuple[float, float],
        kc: float,
        x: tuple[float, float],
        v: tuple[float, float],
        stop_time: float,
        step: float,
        **settings: object,
    ) -> Scene:
        scene = Scene("two_masses", stop_time=stop_time, step=step, **settings)  # type: ignore[arg-type]
        for i, name in enumerate(("one", "two")):
            scene.add(name, mass_fmu, {"k": k[i], "kc": kc, "x_start": x[i], "v_start": v[i]})
        scene.connect("one.x", "two.other").connect("two.x", "one.other")
        return scene.record("one.x", "two.x", "one.v", "two.v")

    return make
