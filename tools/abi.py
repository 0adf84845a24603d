# SPDX-License-Identifier: BSD-3-Clause
"""Compare the C ABI with that of the last release: may a program that was built with it use this library?

    python tools/abi.py            fails if not, and says why
    python tools/abi.py --accept   at a release: later versions are compared with this one

native/abi.xml is the ABI of the last release, as the compiler saw it. It has the arguments of all functions
of unitylink.h, and the members of structs with their places. libabigail (abidw, abidiff) compares it.
New functions are allowed. So are new members at the end of a struct that begins with `size`.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[1]
RELEASED = ROOT / "native" / "abi.xml"
REMEDY = """\
abi.py: a program of the last release could not use this library (see above). Give the changed function or
struct another name, or make this a new major version and accept it: python tools/abi.py --accept"""


def dump() -> str:
    """What the compiler says of the functions in unitylink.h."""
    native = ROOT / "native"
    # The library itself has no debugging information, which is larger than it is. Its functions are enough.
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "libunitylink.so"
        compiler = [os.environ.get("CXX", "g++"), "-std=c++20", "-g", "-O0", "-fPIC", "-fvisibility=hidden"]
        places = [f"-I{native / 'include'}", f"-I{native / 'src'}", '-DUNITYLINK_VERSION=""']
        shown = ["-shared", f"-Wl,--version-script={native / 'unitylink.map'}", "-o", str(library)]
        sources = sorted(map(str, (native / "src" / "abi").glob("*.cpp")))
        subprocess.run([*compiler, *places, *sources, *shown], check=True)
        header = str(native / "include" / "unitylink.h")
        public = ["--exported-interfaces-only", "--drop-private-types", "--header-file", header]
        without_places = ["--no-corpus-path", "--no-comp-dir-path", "--no-show-locs"]
        command = ["abidw", *public, *without_places, str(library)]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def ungrown(old: str, new: str) -> str:
    """`new` without what its structs have gained at their end, where a struct begins with `size`."""
    structs = {struct.get("name"): struct for struct in ElementTree.fromstring(old).iter("class-decl")}
    tree = ElementTree.fromstring(new)
    for struct in tree.iter("class-decl"):
        before = structs.get(struct.get("name"))
        members = [] if before is None else before.findall("data-member/var-decl")
        if before is not None and members and members[0].get("name") == "size":
            for gained in struct.findall("data-member")[len(members) :]:
                struct.remove(gained)
                struct.set("size-in-bits", before.get("size-in-bits", ""))
    return ElementTree.tostring(tree, encoding="unicode")


def difference(old: str, new: str) -> str:
    """What of `old` a program does not find in `new`, in words; empty if it finds all."""
    with tempfile.TemporaryDirectory() as folder:
        was, is_now = Path(folder) / "old.xml", Path(folder) / "new.xml"
        was.write_text(old, encoding="utf-8")
        is_now.write_text(ungrown(old, new), encoding="utf-8")
        command = ["abidiff", "--no-added-syms", "--harmless", str(was), str(is_now)]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
    told = (done.stdout + done.stderr).strip() or f"abidiff says nothing, and ends with {done.returncode}"
    return told if done.returncode else ""


def main() -> int:
    described = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=described)
    parser.add_argument(
        "--accept", action="store_true", help="take the ABI of this library as the released one"
    )
    accept = parser.parse_args().accept
    now = dump()
    if accept:
        RELEASED.write_text(now, encoding="utf-8")
        return 0
    told = difference(RELEASED.read_text("utf-8"), now)
    if told:
        print(told, REMEDY, sep="\n", file=sys.stderr)
    return 1 if told else 0


if __name__ == "__main__":
    sys.exit(main())
