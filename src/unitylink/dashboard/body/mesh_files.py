# SPDX-License-Identifier: BSD-3-Clause
"""Which file a mesh of a URDF is. It must be within the folder of the robot, for strangers write URDFs."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import unquote

from unitylink.errors import UnityLinkError, shown


def mesh_file(name: str, urdf: Path) -> Path:
    """Return the file that a mesh's `filename` means.

    `package://NAME/REST` is REST in the folder NAME, which has the URDF in it, at any depth. Another name is
    relative to the folder of the URDF, and must stay in it or in that of its ROS package. Raises
    UnityLinkError for anything else: no name leads out, not even by a symbolic link.
    """
    folder = urdf.resolve().parent
    scheme, found, rest = name.partition("://")
    if found and scheme == "package":
        package, _, rest = unquote(rest).partition("/")
        root = next((one for one in (folder, *folder.parents) if one.name == package), None)
        if root is None or not package:
            raise UnityLinkError(
                f"{urdf}: mesh {shown(name)}: the URDF is in no folder {shown(package)}, and meshes of "
                "other packages are not read; copy the mesh beside the URDF"
            )
        path = root / rest
    elif found:
        raise UnityLinkError(
            f"{urdf}: mesh {shown(name)}: expected package://NAME/FILE or a name relative to the URDF"
        )
    else:
        root = next((one for one in (folder, *folder.parents) if (one / "package.xml").is_file()), folder)
        path = folder / name
    try:
        path = path.resolve()
        inside = path.is_relative_to(root)
        there = inside and path.is_file()
    except (OSError, ValueError, RuntimeError) as error:  # a loop of links, a NUL
        raise UnityLinkError(f"{urdf}: mesh {shown(name)}: {error}") from error
    if not inside:
        raise UnityLinkError(f"{urdf}: mesh {shown(name)} is outside of {root}; only meshes in it are read")
    if not there:
        raise UnityLinkError(f"{urdf}: mesh {shown(name)}: there is no file {path}")
    return path
