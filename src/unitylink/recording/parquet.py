# SPDX-License-Identifier: BSD-3-Clause
"""Tables in parquet files, with the types that LeRobot reads. It is the only user of pyarrow here."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from unitylink.optional import absent

try:
    import pyarrow as pa
    from pyarrow import parquet
except ImportError:
    raise absent("pyarrow", "a data set of LeRobot") from None

_TYPES = {"float32": pa.float32(), "int64": pa.int64()}
_IMAGE = pa.struct([("bytes", pa.binary()), ("path", pa.string())])


def columns_of(features: Mapping[str, Mapping[str, Any]], columns: Mapping[str, Any]) -> Any:
    """Return a table of frames: a list of fixed length for a feature of several numbers, a number for one.

    A picture is the bytes of a PNG.
    """
    fields, arrays = [], []
    for name, feature in features.items():
        if feature["dtype"] == "image":
            pictures = [{"bytes": one, "path": None} for one in columns[name]]
            fields.append(pa.field(name, _IMAGE))
            arrays.append(pa.array(pictures, type=_IMAGE))
            continue
        kind, numbers = _TYPES[feature["dtype"]], columns[name]
        if feature["shape"] == [1]:
            made = pa.array(numbers.ravel(), type=kind)
        else:
            kind = pa.list_(kind, numbers.shape[1])
            made = pa.FixedSizeListArray.from_arrays(pa.array(numbers.ravel()), type=kind)
        fields.append(pa.field(name, kind))
        arrays.append(made)
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields))


def task_table(tasks: Sequence[str]) -> Any:
    """Return the table of tasks. Pandas has to take its text as the index, so it says so."""
    columns = [_pandas_column("task_index", "int64"), _pandas_column("task", "unicode")]
    told = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": columns,
        "creator": {"library": "pyarrow", "version": pa.__version__},
        "pandas_version": None,
    }
    schema = pa.schema([("task_index", pa.int64()), ("task", pa.string())], {"pandas": json.dumps(told)})
    return pa.Table.from_arrays(
        [pa.array(range(len(tasks)), pa.int64()), pa.array(list(tasks), pa.string())], schema=schema
    )


def _pandas_column(name: str, kind: str) -> dict[str, Any]:
    numpy_type = kind if kind != "unicode" else "object"
    return {
        "name": name,
        "field_name": name,
        "pandas_type": kind,
        "numpy_type": numpy_type,
        "metadata": None,
    }


def write_table(path: Path, table: Any) -> None:
    """Write a table, or {column: values}, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    waiting = path.with_name(f".{path.name}.part")
    parquet.write_table(pa.table(table) if isinstance(table, dict) else table, waiting, compression="snappy")
    os.replace(waiting, path)


def read_columns(path: Path, names: Sequence[str]) -> Any:
    """Return some columns of a table."""
    return parquet.read_table(path, columns=list(names))
