# SPDX-License-Identifier: BSD-3-Clause
"""The reference pages of the site, made from the programs' own texts: help, docstrings, explanations."""

from __future__ import annotations

import inspect
import re
import textwrap
from importlib import import_module
from types import ModuleType

import click

from unitylink.cli import COMMANDS, cli
from unitylink.spec import CODES
from unitylink.spec.report.explain import explain

# module -> title of its page, in the order in which a user meets them
MODULES = {
    "unitylink": "unitylink: connect, links, errors",
    "unitylink.layer4_data": "Layer 4: values, groups, publishing",
    "unitylink.layer3_hardware": "Layer 3: proxies of modules",
    "unitylink.layer2_message": "Layer 2: words at addresses",
    "unitylink.simulate": "Virtual boards and plants",
    "unitylink.testing": "The pytest fixture",
    "unitylink.jupyter": "Notebooks",
    "unitylink.recording": "Recordings",
    "unitylink.capture": "Captures",
    "unitylink.ports": "Ports and the doctor",
    "unitylink.spec": "The specification language",
    "unitylink.errors": "Errors",
}
_WIDTH = 100


def pages() -> dict[str, str]:
    """Return the reference as {file name: Markdown}. The same programs give the same bytes."""
    api = {f"python-{name.replace('.', '-')}.md": _module(name, title) for name, title in MODULES.items()}
    return {"commands.md": _commands(), "diagnostics.md": _diagnostics(), **api}


def _fenced(text: str, language: str = "text") -> str:
    return f"```{language}\n{text.rstrip()}\n```\n"


def _commands() -> str:
    parts = ["# Commands\n\nEach command as `unitylink COMMAND --help` explains it.\n"]
    top = click.Context(cli, info_name="unitylink", terminal_width=_WIDTH, help_option_names=["-h", "--help"])
    parts.append(_fenced(cli.get_help(top)))
    for name, (_, line) in COMMANDS.items():
        command = cli.get_command(top, name)
        assert command is not None
        context = click.Context(command, info_name=name, parent=top, terminal_width=_WIDTH)
        parts.append(f"## {name}\n\n{line}\n\n{_fenced(command.get_help(context))}")
    return "\n".join(parts)


def _diagnostics() -> str:
    parts = ["# Diagnostics\n\nWhat `unitylink check` may say, as `unitylink explain CODE` explains it.\n"]
    for code in CODES:
        one = explain(code)
        parts.append(f"## {code}: {one.title}\n\n*{one.severity}*\n\n{one.text}\n")
        if one.wrong:
            parts.append(f"Wrong:\n\n{_fenced(one.marked)}\nRight:\n\n{_fenced(one.mended)}")
    return "\n".join(parts)


def _module(name: str, title: str) -> str:
    module = import_module(name)
    parts = [f"# {title}\n\n`import {name}`\n", _prose(module.__doc__ or "")]
    for public in _public(module):
        thing = getattr(module, public)
        if inspect.isclass(thing):
            parts.append(_class(public, thing))
        elif callable(thing):
            parts.append(f"## {public}\n\n{_signature(public, thing)}\n{_prose(inspect.getdoc(thing) or '')}")
    return "\n".join(parts)


def _public(module: ModuleType) -> list[str]:
    """Return the public names of a module: its `__all__`, or the names that it defines itself."""
    names = getattr(module, "__all__", None)
    if names is not None:
        return [name for name in names if not name.startswith("__")]
    return [
        name
        for name, thing in vars(module).items()
        if not name.startswith("_") and getattr(thing, "__module__", "") == module.__name__
    ]


def _class(name: str, kind: type) -> str:
    doc = kind.__doc__ or ""
    if doc.startswith(f"{name}("):  # without a docstring, dataclass writes the signature again
        doc = ""
    if issubclass(kind, Exception):
        base = kind.__mro__[1].__name__
        return f"## {name}\n\nA kind of `{base}`.\n\n{_prose(inspect.cleandoc(doc))}"
    parts = [f"## {name}\n\n{_signature(name, kind)}\n{_prose(inspect.cleandoc(doc))}"]
    for member, thing in _members(kind):
        doc = inspect.getdoc(thing) or ""
        if isinstance(thing, property):
            parts.append(f"### {name}.{member}\n\n{_prose(doc)}")
        else:
            function = thing.__func__ if isinstance(thing, (staticmethod, classmethod)) else thing
            parts.append(f"### {name}.{member}\n\n{_signature(member, function)}\n{_prose(doc)}")
    return "\n".join(parts)


def _members(kind: type) -> list[tuple[str, object]]:
    """Return public methods and properties with a docstring. Those inherited from this library count too."""
    found: dict[str, object] = {}
    for base in reversed(kind.__mro__):
        if base.__module__.startswith("unitylink"):
            found |= vars(base)
    methods = (property, staticmethod, classmethod)
    return [
        (name, thing)
        for name, thing in found.items()
        if not name.startswith("_")
        and (isinstance(thing, methods) or inspect.isfunction(thing))
        and inspect.getdoc(thing)
    ]


def _signature(name: str, thing: object) -> str:
    try:
        signature = inspect.signature(thing)  # type: ignore[arg-type]
    except (TypeError, ValueError):  # a type that is written in C, or a Protocol
        return ""
    text = _plain(f"{name}{signature}")
    if len(text) > _WIDTH:  # one parameter in each line
        alone = (_plain(str(signature.replace(parameters=[one]))) for one in _bare(signature))
        stars = {inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.KEYWORD_ONLY}
        lines = [one[1 : one.rindex(")")] for one in alone]
        first = next((i for i, p in enumerate(signature.parameters.values()) if p.kind in stars), None)
        if first is not None and not lines[first].startswith("*"):
            lines.insert(first, "*")
        end = text[text.rindex(")") :]
        text = f"{name}(\n" + "".join(f"    {line},\n" for line in lines) + end
    return _fenced(text, "python")


def _bare(signature: inspect.Signature) -> list[inspect.Parameter]:
    """Return the parameters, each in a form that can stand alone."""
    alone = {inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.POSITIONAL_ONLY}
    named = inspect.Parameter.POSITIONAL_OR_KEYWORD
    return [p.replace(kind=named) if p.kind in alone else p for p in signature.parameters.values()]


def _plain(text: str) -> str:
    """Remove the quotes of annotations, and what differs from run to run."""
    text = re.sub(r"(: |-> )'([^']*)'", r"\1\2", text)
    return re.sub(r" at 0x[0-9a-f]+", "", text).replace("<factory>", "...")


def _prose(doc: str) -> str:
    """Return a docstring as Markdown, with examples and indented text in fences."""
    parts: list[str] = []
    for paragraph in re.split(r"\n\s*\n", inspect.cleandoc(doc)):
        if paragraph.startswith(">>>"):
            parts.append(_fenced(re.sub(r" *# doctest: \+\w+", "", paragraph), "pycon"))
        elif paragraph.startswith("    "):
            parts.append(paragraph if not parts[-1].startswith("    ") else parts.pop() + "\n\n" + paragraph)
        else:
            text, _, example = paragraph.partition("\n>>>")
            parts.append(text + "\n" if "`" in text else text.replace("<", "&lt;") + "\n")
            if example:
                parts.append(_fenced(">>>" + example, "pycon"))
    language = "python" if "import " in doc else "text"
    return "\n".join(_fenced(textwrap.dedent(p), language) if p.startswith("    ") else p for p in parts)
