# SPDX-License-Identifier: BSD-3-Clause
"""`sim:`, `rtl:` and `bit:` URLs: a virtual board that is made when the link is opened."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Union
from urllib.parse import parse_qsl, quote, urlencode

from unitylink import _native
from unitylink.errors import UnityLinkError, UrlError
from unitylink.interface.board_configuration import BoardConfiguration, told_physical
from unitylink.interface.components import placed_components
from unitylink.settings import SETTINGS
from unitylink.spec import load
from unitylink.spec.model import Spec

from .board import Board
from .plant import DEFAULT_PLANT, AnyPlant, load_plant
from .state import BoardState

# A board in this process is silent only if the machine is too busy to run it. A second of a bitstream takes
# half a minute.
_TIMEOUT_S = {"sim": "1", "rtl": "1", "bit": "0.05"}
_OPTIONS = {setting.option: setting for setting in SETTINGS.values() if setting.option}
_Settings = dict[str, Union[int, str]]
_ASKED_FOR = ("spi", "rs485")  # physical layers that never send by themselves


class _Start(NamedTuple):
    """Where a board can be reached, and the state that it goes on from."""

    endpoint: str
    state: BoardState | None


def simulated_board(url: str, state: BoardState | None = None) -> tuple[Board, str]:
    """Make the board of `sim:SPEC.ul?plant=NAME&…`. Return it with the URL for a link to it.

    With `rtl:` instead of `sim:`, the VHDL of the spec is compiled (simulate.rtl). With `bit:`, its bitstream
    is built and run (simulate.bit, docs/bitstream.md). `sim:` too compiles the VHDL if the spec has a
    component of the user's own, of which there is no model, and which the plant does not play.

    The board's options are `root=NAME` (chooses the public constructor or link, if there are several),
    `plant=ramp|loopback|scara|FILE.py`, `seed=NUMBER` (for a plant that has `seed(number)`), and every
    setting that a URL may change (docs/settings.md). All others are the link's. Its `timeout=` is 1 here.
    With a `state` of another board, this one goes on from it, and its plant waits for `go_on`.
    With `time=lockstep`, time goes in steps (docs/lockstep.md). With `reconnect=1`, the board is reached over
    TCP on this computer. For tests,
    `link.board.hang_up()` breaks this line. Close the board after the link.

    Raises UrlError, SpecError, ToolError, ValueRangeError, UnityLinkError.
    """
    kind, path, options = _parts_of(url)
    settings = _settings_in(url, options)
    # a line that is opened again needs a name, and a descriptor has none
    lasts = options.get("reconnect", "0") != "0"
    endpoint = "tcp" if lasts else "fd"
    if _in_steps(url, options):
        if lasts:
            raise UrlError(f"{url!r}: a line in steps is never lost; leave out reconnect= or time=lockstep")
        endpoint = "lockstep"
    board = _KINDS[kind](url, path, options, settings, _Start(endpoint, state))
    options.setdefault("timeout", _TIMEOUT_S[kind])
    if board.configuration.protocol == "framed":  # a request in text would only cost time
        options.setdefault("protocol", "framed")
    try:
        link_url = f"{board.url}?{urlencode(options, safe=',/', quote_via=quote)}"
    except UnityLinkError:
        board.close()
        raise
    return board, link_url


def check_simulated(url: str) -> None:
    """Check such a URL and the spec that it names, without making the board.

    Raises UrlError or SpecError.
    """
    _, path, options = _parts_of(url)
    _in_steps(url, options)
    _spec_in(url, path, options)
    _settings_in(url, options)


def _parts_of(url: str) -> tuple[str, str, dict[str, str]]:
    """Return the scheme, the path of the spec, and the options of such a URL."""
    kind, _, rest = url.partition(":")
    path, _, query = rest.partition("?")
    if kind not in _KINDS or not path:
        forms = " or ".join(f"{kind}:SPEC.ul" for kind in _KINDS)
        raise UrlError(f"{url!r}: expected {forms}, with ?option=value&… behind it")
    try:
        options = dict(parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query)))
    except ValueError as error:
        raise UrlError(f"{url!r}: {error}; options are option=value, with & between them") from error
    return kind, path, options


def _in_steps(url: str, options: dict[str, str]) -> bool:
    """Take `time=` out of the options. Does it say that time goes in steps?"""
    time = options.pop("time", "real")
    if time not in ("real", "lockstep"):
        raise UrlError(f"{url!r}: time={time}; expected real or lockstep")
    return time == "lockstep"


def _spec_in(url: str, path: str, options: dict[str, str]) -> Spec:
    """Return the spec in the file `path`, or the part of it that `root=` chooses."""
    try:
        spec = load(path)
    except OSError as error:
        raise UrlError(f"{url!r}: {path}: {error.strerror or error}") from error
    root = options.get("root")
    if root is None:
        return spec
    try:
        return spec.only(root)
    except KeyError as error:
        raise UrlError(f"{url!r}: {error.args[0]}") from None


def _settings_in(url: str, options: dict[str, str]) -> _Settings:
    """Take the settings of the board out of `options`.

    The link also gets the settings that a device tells by itself.
    """
    settings: _Settings = {}
    for option in set(options) & set(_OPTIONS):
        setting = _OPTIONS[option]
        text = options[option] if setting.told else options.pop(option)
        try:
            settings[setting.name] = text if setting.type == "choice" else int(text.split(",")[0], 0)
        except ValueError as error:
            raise UrlError(f"{url!r}: {option}={text} is not a whole number") from error
    return settings


def _needs_vhdl(spec: Spec, plant: AnyPlant) -> bool:
    """Does the spec have a component of the user's own that neither a model nor the plant plays?"""
    plays = getattr(plant, "plays", ())
    return any(
        one.sources and one.entity not in plays and not _native.has_component_model(one.entity)
        for one in placed_components(spec)
    )


def _twin(
    url: str,
    path: str,
    options: dict[str, str],
    settings: _Settings,
    start: _Start,
) -> Board:
    spec = _spec_in(url, path, options)
    plant = _plant_for(spec, url, options)
    if _needs_vhdl(spec, plant):
        return _compiled(url, spec, plant, options, settings=settings, start=start)
    configuration = BoardConfiguration.for_spec(spec, **settings)
    return Board(spec, configuration=configuration, plant=plant, endpoint=start.endpoint, state=start.state)


def _gateware(
    url: str,
    path: str,
    options: dict[str, str],
    settings: _Settings,
    start: _Start,
) -> Board:
    spec = _spec_in(url, path, options)
    return _compiled(url, spec, _plant_for(spec, url, options), options, settings=settings, start=start)


def _compiled(
    url: str,
    spec: Spec,
    plant: AnyPlant,
    options: dict[str, str],
    *,
    settings: _Settings,
    start: _Start,
) -> Board:
    from .rtl import RtlBoard, rtl_configuration  # here, because it loads the generator and the compilers

    _check_fresh(url, start)
    physical = settings.get("physical", told_physical(spec))
    if physical in _ASKED_FOR:
        raise UrlError(
            f"{url!r}: {physical} sends only when a master asks, and an rtl: link is not a master; write "
            f"physical=uart, or use RtlBoard and a {physical}: link (docs/{physical}.md)"
        )
    configuration = rtl_configuration(spec, **settings)
    steps = options.pop("trace_program", "")
    return RtlBoard(
        spec, configuration=configuration, plant=plant, endpoint=start.endpoint, trace_program=steps
    )


def _bitstream(
    url: str,
    path: str,
    options: dict[str, str],
    settings: _Settings,
    start: _Start,
) -> Board:
    from .bit.link import (
        Wish,
        bit_board,
        names_spec,
    )  # here, because it loads the generator and the compilers

    _check_fresh(url, start)
    own = options.pop("spec", None)
    file = path if names_spec(path) else own
    spec = None if file is None else _spec_in(url, file, options)
    return bit_board(Wish(url, path, options, settings), spec, start.endpoint)


def _check_fresh(url: str, start: _Start) -> None:
    if start.state is not None:
        raise UrlError(f"{url!r}: only the twin goes on from a state; compiled gateware begins at its reset")


def _plant_for(spec: Spec, url: str, options: dict[str, str]) -> AnyPlant:
    options.pop("root", None)
    plant = load_plant(options.pop("plant", DEFAULT_PLANT), spec)
    seed = options.pop("seed", None)
    if seed is not None:
        if not seed.isdigit():
            raise UrlError(f"{url!r}: seed={seed} is not a whole number from 0")
        if hasattr(plant, "seed"):  # others are the same each time
            plant.seed(int(seed))
    return plant


_Maker = Callable[[str, str, dict[str, str], _Settings, _Start], Board]
_KINDS: dict[str, _Maker] = {"sim": _twin, "rtl": _gateware, "bit": _bitstream}
