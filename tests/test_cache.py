"""The cache: addressed by all that an entry depends on, never believed blindly, never needed."""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from shutil import copytree, ignore_patterns

import pytest

from curvebound import cache
from curvebound.cli import main
from curvebound.cosim import capabilities
from curvebound.errors import CurveboundError
from curvebound.fmi import binaries, cached, documentation
from curvebound.fmi import compile as kernel
from curvebound.fmi.cached import cached_fmu
from curvebound.fmi.folder import Folder, find

SOURCES = Path(cache.__file__).parents[1]
#: what another process does first, to build in less time: nothing compiled, no reference result
QUICK = (
    "from curvebound.fmi import compile as kernel, documentation\n"
    "kernel.why_not = lambda *_, **__: 'no C compiler found'\n"
    "documentation.reference_result = lambda _: None\n"
)


@pytest.fixture(autouse=True)
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("CURVEBOUND_CACHE", str(tmp_path / "store"))
    return tmp_path / "store"


class Maker:
    """Writes a file, and counts how often it was asked to."""

    def __init__(self, content: bytes = b"made") -> None:
        self.content = content
        self.times = 0

    def __call__(self, folder: Path) -> None:
        self.times += 1
        (folder / "sub").mkdir()
        (folder / "sub" / "file.bin").write_bytes(self.content)


def read(folder: Path) -> bytes:
    return (folder / "sub" / "file.bin").read_bytes()


def test_what_is_there_is_not_made_again() -> None:
    make = Maker()
    first = cache.entry("things", ["a", b"b"], make)
    assert cache.entry("things", ["a", b"b"], make) == first
    assert read(first) == b"made"
    assert make.times == 1


@pytest.mark.parametrize(
    ("kind", "parts"), [("others", ["a", "b"]), ("things", ["ab"]), ("things", ["a", "b", ""])]
)
def test_another_part_is_another_entry(kind: str, parts: list[str]) -> None:
    make = Maker()
    assert cache.entry("things", ["a", "b"], make) != cache.entry(kind, parts, make)
    assert make.times == 2


def test_sources_count_by_name_and_content(tmp_path: Path) -> None:
    folder = tmp_path / "sources"
    (folder / "__pycache__").mkdir(parents=True)
    (folder / "a.py").write_text("1")
    seen = {cache.sources(folder)}
    (folder / "__pycache__" / "a.pyc").write_text("2")
    assert cache.sources(folder) in seen
    (folder / "a.py").write_text("2")
    seen.add(cache.sources(folder))
    (folder / "a.py").rename(folder / "b.py")
    seen.add(cache.sources(folder))
    assert len(seen) == 3


def cut(entry: Path) -> None:
    (entry / "sub" / "file.bin").write_bytes(b"ma")


def add(entry: Path) -> None:
    (entry / "more.so").write_bytes(b"planted")


def swap(entry: Path) -> None:
    (entry / "sub" / "file.bin").unlink()
    (entry / "sub" / "file.bin").symlink_to("/etc/hostname")


def forge(entry: Path) -> None:
    text = (entry / "contents.json").read_text()
    (entry / "contents.json").write_text(text.replace(entry.name, "0" * 32))


def empty(entry: Path) -> None:
    (entry / "contents.json").write_text("[]")


def lose(entry: Path) -> None:
    (entry / "contents.json").unlink()


def open_up(entry: Path) -> None:
    entry.chmod(0o777)


@pytest.mark.parametrize("damage", [cut, add, swap, forge, empty, lose, open_up])
def test_a_damaged_entry_is_made_again(damage: Callable[[Path], None], store: Path) -> None:
    make = Maker()
    damage(cache.entry("things", ["a"], make))
    again = cache.entry("things", ["a"], make)
    assert (make.times, read(again), again.parent.parent) == (2, b"made", store)
    assert cache.entry("things", ["a"], make) == again
    assert make.times == 2
    left = [p.name for p in again.parent.iterdir()]
    assert left == [again.name]


@pytest.mark.parametrize("which", ["store", "kind"])
def test_a_folder_that_others_may_write_to_is_not_used(which: str, store: Path, caplog) -> None:
    make = Maker()
    planted = cache.entry("things", ["a"], make)
    (store if which == "store" else store / "things").chmod(0o777)
    used = cache.entry("things", ["a"], make)
    assert used != planted
    assert make.times == 2
    assert "chmod go-w" in caplog.text
    assert "CURVEBOUND_CACHE" in caplog.text


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="root only")
def test_a_folder_of_another_user_is_not_used(store: Path, caplog) -> None:
    make = Maker()
    planted = cache.entry("things", ["a"], make)
    os.chown(store, 12345, 12345)
    assert cache.entry("things", ["a"], make) != planted
    assert "belongs to user 12345" in caplog.text


def test_what_is_made_can_be_changed_by_nobody_else(store: Path) -> None:
    before = os.umask(0)
    try:
        made = cache.entry("things", ["a"], Maker())
    finally:
        os.umask(before)
    for path in (store, made.parent, made, *made.rglob("*")):
        assert path.stat().st_mode & 0o022 == 0, path


@pytest.mark.parametrize("place", ["a file", "no home", "no permission"])
def test_no_cache_costs_time_and_nothing_else(
    place: str, store: Path, monkeypatch: pytest.MonkeyPatch, caplog
) -> None:
    if place == "a file":
        store.write_text("")
    elif place == "no permission":
        monkeypatch.setenv("CURVEBOUND_CACHE", "/proc/self/curvebound")
    else:
        monkeypatch.delenv("CURVEBOUND_CACHE")
        monkeypatch.delenv("XDG_CACHE_HOME", raising=False)

        def homeless() -> Path:
            raise RuntimeError("Could not determine home directory.")

        monkeypatch.setattr(Path, "home", homeless)
    make = Maker()
    with caplog.at_level(logging.WARNING):
        for _ in range(3):
            assert read(cache.entry("things", ["a"], make)) == b"made"
    assert make.times == 1
    assert len(caplog.records) == 1
    # the processes that this one starts share what was made
    script = "from curvebound import cache; print(cache.entry('things', ['a'], None))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (Path(done.stdout.strip()) / "sub" / "file.bin").read_bytes() == b"made"
    assert done.stderr == ""


def test_a_full_disk_costs_time_and_nothing_else(monkeypatch: pytest.MonkeyPatch, caplog) -> None:
    put, calls = cache._put, []

    def full(*arguments: object) -> None:
        calls.append(arguments)
        if len(calls) == 1:
            raise OSError(28, "No space left on device")
        put(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(cache, "_put", full)
    assert read(cache.entry("things", ["a"], Maker())) == b"made"
    assert "No space left on device" in caplog.text


def test_what_fails_to_be_made_is_no_failure_of_the_cache(store: Path, caplog) -> None:
    def fail(folder: Path) -> None:
        (folder / "half").write_text("")
        raise CurveboundError("the compiler is out of order")

    for _ in range(2):
        with pytest.raises(CurveboundError, match="out of order"):
            cache.entry("things", ["a"], fail)
    assert list((store / "things").iterdir()) == []
    assert caplog.text == ""


def test_many_at_once_make_it_once() -> None:
    started, go = threading.Event(), threading.Event()
    make = Maker()

    def slowly(folder: Path) -> None:
        started.set()
        go.wait(10.0)
        make(folder)

    one = threading.Thread(target=cache.entry, args=("things", ["a"], slowly))
    one.start()
    started.wait(10.0)
    other = threading.Thread(target=cache.entry, args=("things", ["a"], make))
    other.start()
    go.set()
    one.join(20.0)
    other.join(20.0)
    assert make.times == 1


def test_what_was_not_used_for_longest_gives_way(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "_MOST", 30_000)
    entries = [cache.entry("things", [str(i)], Maker(bytes(10_000))) for i in range(2)]
    os.utime(entries[1], (1e9, 1e9))
    entries += [cache.entry("things", [str(i)], Maker(bytes(10_000))) for i in (2, 3)]
    assert [entry.is_dir() for entry in entries] == [True, False, True, True]


def test_a_truncated_kernel_is_not_packed(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def compiled(source: Path, target: str, level: str) -> Path:
        made = source.with_suffix(".so")
        made.write_bytes(b"a whole kernel")
        return made

    core = kernel.runtime()
    monkeypatch.setattr(kernel, "compile_c", compiled)
    monkeypatch.setattr(kernel, "compiled_directory", lambda: tmp_path)
    monkeypatch.setattr(kernel, "_c_sources", lambda core, system: tmp_path / "none")
    (tmp_path / "none").mkdir()
    monkeypatch.setattr(kernel, "SUFFIXES", {"linux64": ".so"})
    assert kernel.extension("linux64", core, None) == b"a whole kernel"
    (file,) = store.rglob("*.so")
    file.write_bytes(b"a whole")
    assert kernel.extension("linux64", core, None) == b"a whole kernel"


@pytest.fixture(scope="module")
def natives() -> dict[str, Path | None]:
    """The binaries of FMUs, by platform, from the cache of all tests."""
    return {name: binaries.compile_binary(name) for name in binaries.PLATFORMS}


@pytest.fixture
def quick(natives: dict[str, Path | None], monkeypatch: pytest.MonkeyPatch) -> None:
    """QUICK, in this process, as if it had built nothing yet."""
    for module in (binaries, cached):
        monkeypatch.setattr(module, "compile_binary", natives.get)
    monkeypatch.setattr(kernel, "why_not", lambda *_, **__: "no C compiler found")
    monkeypatch.setattr(documentation, "reference_result", lambda _: None)
    monkeypatch.setattr(capabilities, "_BUILT", {})


@pytest.mark.usefixtures("quick")
def test_other_sources_are_another_fmu(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A changed system, or a changed package; of builds that write a file and nothing else."""

    def build(folder: Folder, to: Path) -> None:
        (to / f"{folder.name}.fmu").touch()

    monkeypatch.setattr("curvebound.fmi.build.build", build)
    first = cached_fmu(find("BeadOnWire"))
    copy = tmp_path / "bead_on_wire"
    copytree(find("BeadOnWire").path, copy, ignore=ignore_patterns("__pycache__"))
    (copy / "base.py").write_text((copy / "base.py").read_text() + "\n# another branch\n")
    other = cached_fmu(find(str(copy)))
    assert other != first == cached_fmu(find("BeadOnWire"))
    monkeypatch.setattr(cached, "_PACKAGE", copy)
    assert cached_fmu(find("BeadOnWire")) not in (first, other)


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
def test_other_sources_are_another_fmu_in_another_place(tmp_path: Path) -> None:
    """Two checkouts, or a branch and what it changed, never meet each other's."""
    first = cached_fmu(find("BeadOnWire"))
    bytes_of_first = first.read_bytes()
    assert cached_fmu(find("BeadOnWire")) == first
    copy = tmp_path / "checkout"
    ignored = ignore_patterns("__pycache__")
    copytree(SOURCES, copy / "src", ignore=ignored)
    copytree(SOURCES.parent / "fmus", copy / "fmus", ignore=ignored)
    (copy / "LICENSE").write_bytes((SOURCES.parent / "LICENSE").read_bytes())
    model = copy / "fmus" / "bead_on_wire" / "base.py"
    model.write_text(model.read_text() + "\n# another branch\n")
    script = (
        f"{QUICK}from curvebound.fmi.cached import cached_fmu\n"
        "from curvebound.fmi.folder import find\n"
        "print(cached_fmu(find('BeadOnWire')))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        cwd=copy,
        env={**os.environ, "PYTHONPATH": str(copy / "src")},
        capture_output=True,
        text=True,
        check=True,
    )
    other = Path(done.stdout.strip())
    assert other != first
    assert other.read_bytes() != bytes_of_first == first.read_bytes()


@pytest.mark.usefixtures("quick")
def test_a_scene_runs_without_a_home(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """A container run as another user, HOME=/: nothing but a line about the cache."""
    monkeypatch.delenv("CURVEBOUND_CACHE")
    home = tmp_path / "home"
    home.write_text("")  # root may write to a folder without permission; to a file it may not
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.chdir(tmp_path)
    assert main(["run", "bead_on_wire", "--stop", "0.1", "--out", "bead.csv"]) == 0
    assert (tmp_path / "bead.csv").is_file()
    assert "There is no cache" in caplog.text


def test_the_list_of_contents_is_plain(store: Path) -> None:
    made = cache.entry("things", ["a"], Maker())
    listed = json.loads((made / "contents.json").read_text())
    assert list(listed["files"]) == ["sub/file.bin"]


def test_what_a_stopped_process_left_is_removed_once_it_is_old() -> None:
    folder = cache.entry("things", ["a"], Maker()).parent
    now = time.time()
    for name, age in ((".put-old", 86_460), (".put-new", 86_340), (".old.lock", 1e6)):
        (folder / name).mkdir()
        os.utime(folder / name, (now - age, now - age))
    (folder / ".file").touch()
    os.utime(folder / ".file", (1e9, 1e9))
    cache.entry("things", ["b"], Maker())
    assert sorted(p.name for p in folder.glob(".*")) == [".old.lock", ".put-new"]


def test_a_store_of_its_own_goes_with_the_process_that_made_it(tmp_path: Path) -> None:
    own = tmp_path / "own"
    own.mkdir()
    cache._remove_own(own, os.getpid() + 1)  # a fork of it ends
    assert own.is_dir()
    cache._remove_own(own, os.getpid())
    assert not own.exists()
