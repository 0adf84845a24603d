# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink gateware`: the VHDL library, listed or as a folder for the tools of others."""

from __future__ import annotations

from pathlib import Path

import click

from .failure import Failure


@click.command()
@click.argument("spec_file", metavar="[SPEC]", required=False)
@click.option("--export", "folder", metavar="DIR", help="Write it to this folder, which is new or empty.")
def command(spec_file: str | None, folder: str | None) -> None:
    """List the files of the VHDL library, in the order of their compilation, or export it for other tools.

    The folder of --export has the VHDL, core files for FuseSoC, `vunit_unitylink.py` for VUnit, and lists for
    Vivado, Quartus, Diamond, Radiant, Libero and Gowin EDA. With SPEC it also has the design of the spec,
    each board a core for FuseSoC.

    \b
    Examples:
      unitylink gateware
      unitylink gateware --export hdl
      unitylink gateware arm.ul --export hdl
    """
    from unitylink import __version__
    from unitylink.gateware import LIBRARY, export_gateware, gateware_sources
    from unitylink.gateware.dependencies import in_order

    if folder is None:
        if spec_file is not None:
            raise click.UsageError(
                "SPEC is for --export DIR; `unitylink generate SPEC --only vhdl` makes VHDL"
            )
        for path in in_order(gateware_sources()):
            click.echo(f"{LIBRARY} {path}")
        return
    files = export_gateware(__version__)
    if spec_file is not None:
        files |= _designs(spec_file, __version__)
    place = Path(folder)
    if place.exists() and (not place.is_dir() or any(place.iterdir())):
        raise Failure(f"{place} exists and is not empty", "name a new folder, or remove what is in it")
    try:
        for name, data in files.items():
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            (place / name).write_bytes(data)
    except OSError as error:
        raise Failure(f"{place}: {error.strerror or error}", "name a folder that can be written to") from None
    for name in files:
        if "/" not in name:
            click.echo(f"wrote {place / name}")
    click.echo(f"{len(files)} files")


def _designs(spec_file: str, version: str) -> dict[str, bytes]:
    """Return {file name: contents} of the designs of a spec, each with its core file."""
    import json

    from unitylink.gateware.export import design_core
    from unitylink.generate import generate
    from unitylink.spec import load

    spec = load(spec_file)
    vhdl = {name: text for name, text in generate(spec, "vhdl").items() if name.endswith(".vhd")}
    made = {name: text.encode() for name, text in vhdl.items()}
    boards = [Path(name).stem.removesuffix("_top") for name in vhdl if name.endswith("_top.vhd")]

    def board_of(name: str) -> str:  # arm_left_top.vhd is of arm_left, and not of arm
        return max((one for one in boards if Path(name).stem.startswith(f"{one}_")), key=len, default="")

    for board in boards:
        sources = [name for name in vhdl if board_of(name) == board]
        description = json.dumps(f"The design of {Path(spec_file).name}")
        made[f"{board}.core"] = design_core(board, version, sources, description).encode()
    return made
