# SPDX-License-Identifier: BSD-3-Clause
"""What users install: a wheel without a compiler or a checkout, an sdist with a compiler, the core for C."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest

from .conftest import ROOT, UNITYLINK

BIN = Path(sys.executable).parent
FIRST_HOUR = ROOT / "docs" / "first-hour.md"
WHEEL_BYTES_MOST = 4_000_000
PATIENCE_S = 600  # for a build on a loaded machine


def call(*command: object, cwd: Path, **environment: str) -> str:
    done = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env={**os.environ, **environment},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout[-6000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheels")
    call(ROOT / "tools" / "wheel.sh", folder, cwd=ROOT)
    return folder


@pytest.fixture(scope="module")
def fresh(wheels: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel installed in it. Its dependencies come from the environment of the tests."""
    folder = tmp_path_factory.mktemp("fresh")
    (wheel,) = wheels.glob("*.whl")
    options = ("--quiet", "--no-deps", "--no-index", "--target", folder)
    call(sys.executable, "-m", "pip", "install", *options, wheel, cwd=folder)
    return folder


# Without `site`, which would put the checkout first.
INSTALLED = (sys.executable, "-S", "-m", "unitylink")


def only(fresh: Path) -> dict[str, str]:
    """Return an environment in which Python finds what is installed in `fresh`, and not the checkout."""
    return {"PYTHONPATH": os.pathsep.join((str(fresh), sysconfig.get_path("purelib")))}


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    prefix = tmp_path_factory.mktemp("prefix")
    call(BIN / "cmake", "--install", ROOT / "build" / "native", "--prefix", prefix, cwd=ROOT)
    return prefix


@pytest.mark.xdist_group("install")
class TestWheel:
    """From `pip install WHEEL` on: no compiler, no checkout, only the wheel and the package index."""

    def test_the_wheel_is_for_many_linuxes_and_contains_all_resources(self, wheels: Path) -> None:
        (wheel,) = wheels.glob("*.whl")
        assert "manylinux" in wheel.name
        listed = call(sys.executable, "-m", "zipfile", "--list", wheel, cwd=ROOT)
        for part in (
            "share/gateware/core.vhd",
            "share/boards/icebreaker/board.toml",
            "share/examples/scara/scara.ul",
            "proxies.py.jinja",
            "py.typed",
        ):
            assert part in listed, part
        assert "__pycache__" not in listed and "unitylink_lab" not in listed
        assert not re.search(r"_tb\.vhd\s", listed)  # but a template of a bench is there
        package = ROOT / "src" / "unitylink"
        files = [
            p.relative_to(package.parent) for p in package.rglob("*") if p.suffix != ".so" and p.is_file()
        ]
        # check every file, because only users would notice a pattern that leaves out too much
        for file in files:
            shipped = f"{file} " in listed
            assert shipped or file.parent.name == "__pycache__", file
        assert "share/examples/scara/run.py" in listed
        assert "examples/c_reader/" not in listed and "examples/ros/" not in listed
        assert "share/tools/wireshark/unitylink.lua" in listed

    def test_it_is_small_and_has_its_bill_of_materials(self, wheels: Path) -> None:
        (wheel,) = wheels.glob("*.whl")
        assert wheel.stat().st_size < WHEEL_BYTES_MOST
        with zipfile.ZipFile(wheel) as opened:
            (name,) = (one for one in opened.namelist() if one.endswith("sboms/unitylink.cdx.json"))
            bill = json.loads(opened.read(name))
        assert {"required", "optional"} == {one["scope"] for one in bill["components"]}
        assert bill["metadata"]["component"]["name"] == "unitylink"

    def test_two_builds_are_equal_byte_by_byte(self, wheels: Path, tmp_path: Path) -> None:
        call(ROOT / "tools" / "wheel.sh", tmp_path, cwd=ROOT)
        assert {one.name for one in wheels.iterdir()} == {one.name for one in tmp_path.iterdir()}
        for one in tmp_path.iterdir():
            assert one.read_bytes() == (wheels / one.name).read_bytes(), one.name

    def test_its_metadata_name_its_owner_and_its_purpose(self, fresh: Path) -> None:
        (metadata,) = fresh.glob("unitylink-*.dist-info/METADATA")
        said = metadata.read_text("utf-8")
        assert "Author: The Unity-Link authors" in said and "Typing :: Typed" in said
        assert re.search(r"^Project-URL: .*https://", said, re.M)
        assert str(fresh) in call(*INSTALLED, "--version", cwd=fresh, **only(fresh))

    @pytest.mark.parametrize(
        ("words", "code"),
        [("bench", 2), ("experiments", 2), ("conformance x.json", 2), ("faults --beside litex", 1)],
    )
    def test_a_wheel_has_no_command_that_needs_a_checkout(self, fresh: Path, words: str, code: int) -> None:
        if code == 2:
            assert f"\n  {words.split(maxsplit=1)[0]} " not in call(
                *INSTALLED, "--help", cwd=fresh, **only(fresh)
            )
        done = subprocess.run(
            [*INSTALLED, *words.split()],
            cwd=fresh,
            env={**os.environ, **only(fresh)},
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert done.returncode == code and "needs a checkout of the source" in done.stderr

    def test_the_first_hour_goes_as_written(self, wheels: Path, tmp_path: Path) -> None:
        """Without a compiler, a robot moves with no publish lost, and a spec of one's own works."""
        (wheel,) = wheels.glob("*.whl")
        page = tmp_path / "first-hour.md"
        call(sys.executable, ROOT / "tools" / "docs" / "first_hour.py", wheel, "--out", page, cwd=tmp_path)
        written, shown = (p.read_text("utf-8").splitlines() for p in (FIRST_HOUR, page))
        assert written == shown, "docs/first-hour.md is not what tools/docs/first_hour.py writes"

    def test_its_gateware_is_a_board_too(self, fresh: Path) -> None:
        link = f"rtl:{fresh}/unitylink/share/examples/hello_led/hello_led.ul"
        assert "uptime_ms" in call(*INSTALLED, "read", link, "*", cwd=fresh, **only(fresh))

    def test_the_sdist_has_what_the_build_needs(self, wheels: Path) -> None:
        (sdist,) = wheels.glob("*.tar.gz")
        with tarfile.open(sdist) as archive:
            names = {name.partition("/")[2] for name in archive.getnames()}
            for folder in ("native/src", "native/include", "native/python", "cmake"):
                for source in filter(Path.is_file, (ROOT / folder).rglob("*")):
                    name = f"{sdist.name.removesuffix('.tar.gz')}/{source.relative_to(ROOT)}"
                    packed = archive.extractfile(name)
                    assert packed is not None and packed.read() == source.read_bytes(), name
        needed = {
            "CMakeLists.txt",
            "pyproject.toml",
            "LICENSE",
            "native/include/unitylink.h",
            "gateware/core.vhd",
        }
        assert needed <= names
        assert not [name for name in names if name.startswith(("tests/", "build/", ".venv/"))]

    @pytest.mark.long  # the test above compares everything that this compiles, byte by byte
    def test_the_sdist_builds_with_a_compiler_alone(self, wheels: Path, tmp_path: Path) -> None:
        (sdist,) = wheels.glob("*.tar.gz")
        # The core's sources in it are those of this checkout, byte by byte. They were compiled to run this
        # test.
        compiled = ROOT / (ROOT / ".venv" / ".compiled").read_text("utf-8").strip()
        settings = {
            "cmake.define.UNITYLINK_OBJECTS": compiled,
            "cmake.build-type": "Debug",
            "cmake.define.CMAKE_CXX_FLAGS_DEBUG": "-O0",
        }
        options = [f"--config-settings={name}={value}" for name, value in settings.items()]
        call(sys.executable, "-m", "venv", "venv", cwd=tmp_path)
        call("venv/bin/pip", "install", "--quiet", *options, sdist, cwd=tmp_path)
        assert "classic" in call("venv/bin/unitylink", "--version", cwd=tmp_path)


class TestCore:
    """The core without Python, as C and C++ programs find it."""

    def read_with(self, reader: Path, tmp_path: Path, **environment: str) -> None:
        spec = ROOT / "examples" / "hello_led" / "hello_led.ul"
        with subprocess.Popen(
            [UNITYLINK, "simulate", spec, "--tcp", "0"], stdout=subprocess.PIPE, text=True, cwd=tmp_path
        ) as board:
            try:
                assert board.stdout is not None
                found = re.search(r"tcp://\S+", board.stdout.readline())
                assert found
                call(reader, found[0], "0x20", "2", cwd=tmp_path, **environment)
            finally:
                board.terminate()

    def test_cmake_finds_it(self, prefix: Path, tmp_path: Path) -> None:
        source = ROOT / "examples" / "c_reader"
        call(BIN / "cmake", "-S", source, "-B", "b", f"-DCMAKE_PREFIX_PATH={prefix}", cwd=tmp_path)
        call(BIN / "cmake", "--build", "b", cwd=tmp_path)
        self.read_with(tmp_path / "b" / "reader", tmp_path)

    def test_cmake_builds_a_program_with_generated_headers(self, prefix: Path, tmp_path: Path) -> None:
        source = ROOT / "examples" / "control_loop"
        found = (f"-DCMAKE_PREFIX_PATH={prefix}", f"-DUNITYLINK={UNITYLINK}")
        call(BIN / "cmake", "-S", source, "-B", "b", *found, cwd=tmp_path)
        call(BIN / "cmake", "--build", "b", cwd=tmp_path)
        for program in ("loop", "loop_c"):
            usage = subprocess.run([tmp_path / "b" / program], check=False, capture_output=True, text=True)
            assert (usage.returncode, usage.stderr) == (2, "usage: loop LINK ANGLE SECONDS\n")

    def test_pkg_config_finds_it(self, prefix: Path, tmp_path: Path) -> None:
        pkg_config = shutil.which("pkg-config")
        assert pkg_config, "pkg-config is missing: install the Debian package pkg-config"
        page = (ROOT / "docs" / "install.md").read_text("utf-8")
        (exported,) = re.findall(r"^export (.* CMAKE_PREFIX_PATH=.*)", page, re.M)
        places = dict(one.split("=") for one in exported.replace("~/.local", str(prefix)).split())
        flags = call(pkg_config, "--cflags", "--libs", "unitylink", cwd=tmp_path, **places).split()
        source = ROOT / "examples" / "c_reader" / "reader.c"
        call(os.environ.get("CC", "cc"), "-std=c11", source, *flags, "-o", "reader", cwd=tmp_path)
        self.read_with(tmp_path / "reader", tmp_path, **places)
