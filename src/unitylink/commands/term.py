# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink term`: a terminal for typing classic commands."""

from __future__ import annotations

import re
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

import click

from unitylink import protocol
from unitylink.capture import CaptureMessage, MessageReader, Pieces
from unitylink.connection.schemes import scheme_of
from unitylink.errors import LinkError
from unitylink.layer1_stream import ClassicEncoder
from unitylink.optional import absent

from .failure import Failure
from .link_option import link_argument, load_names, spec_option
from .names import Names
from .wire_reader import wire_reader

if TYPE_CHECKING:
    from unitylink.layer0_driver import Driver

_COMMANDS = {
    protocol.COMMAND_READ: "#R:address                 read a word",
    protocol.COMMAND_READ_MANY: "#RM:count addresses        read 1 to 255 words in one go",
    protocol.COMMAND_WRITE: "#W:address word            write a word",
    protocol.COMMAND_READ_CONFIGURATION: "#RLC                       the configuration",
    protocol.COMMAND_WRITE_GROUP_ADDRESSES: "#WSA:group count addresses what a group publishes",
    protocol.COMMAND_WRITE_GROUP_RATE: "#WSR:group rate            every rate-th base period; 0 is off",
    protocol.COMMAND_READ_GROUP: "#RSI:group                 what a group is set to",
    protocol.COMMAND_ENABLE_PUBLISHING: "#EPS                       publishing on",
    protocol.COMMAND_ENABLE_CHECKED_PUBLISHING: "#EPC                       publishing on, with checksums",
    protocol.COMMAND_DISABLE_PUBLISHING: "#DPS                       publishing off",
    protocol.COMMAND_WRITE_EVENT_MASK: "#WIC:mask                  groups that publish on event",
    protocol.COMMAND_READ_EVENT_MASK: "#RIC                       the same, read",
}
_HELP = """Type a command; `$` instead of `#` adds a checksum by itself. Names of the spec stand for their
addresses: `#R:x.position`. TAB completes commands and names. .help shows this, .quit or Ctrl-D ends.
"""
_LINE = re.compile(r"([#$])([A-Za-z]*)(?::(.*?))?(?:\*([0-9A-Fa-f]{2}))?$")
_ADDRESS_OR_NAME = re.compile(r"[A-Za-z_][\w.\[\]]*")
_ANSWER_S = 1.0  # how long a script waits for the answer to a line


@click.command()
@link_argument
@spec_option
def command(link: str, spec_file: str | None) -> None:
    """Type classic commands to a device. See its replies and publishes, each with its meaning.

    Checksums are added, and names stand for addresses. Lines may also come from a pipe. Then each line waits
    for its reply.

    \b
    Examples:
      unitylink term sim:arm.ul
      unitylink term "serial:/dev/ttyUSB0?baud=3000000" --spec arm.ul
      printf '#RLC\\n#R:x.position\\n' | unitylink term sim:arm.ul
    """
    if scheme_of(link).name == "rs485":
        raise Failure(f"{link} carries only frames, and this command sends text", "`unitylink read` asks it")
    names = load_names(link, spec_file)
    from unitylink.connection import open_driver

    with open_driver(link) as driver:
        session = Session(driver, names)
        for said in session.begin():
            click.echo(said)
        if sys.stdin.isatty() and sys.stdout.isatty():
            _talk(session, link)
        else:
            _script(session, sys.stdin)


class Session:
    """One conversation as text: typed lines go in, sent and received messages come out."""

    def __init__(self, driver: Driver, names: Names) -> None:
        self.driver = driver
        self.names = names
        self.reader: MessageReader = wire_reader(names)
        self._pieces = Pieces()
        self._start_s = time.monotonic()

    def begin(self) -> Iterator[str]:
        """Ask for the configuration, which tells the width of addresses. Yield the messages of this."""
        yield self.send(f"#{protocol.COMMAND_READ_CONFIGURATION}")
        end_s = time.monotonic() + _ANSWER_S
        while self.reader.address_bytes is None and time.monotonic() < end_s:
            yield from self.receive(end_s - time.monotonic())

    def send(self, line: str) -> str:
        """Send a line.

        Return its interpretation. Raises ValueError for a name that the spec does not have.
        """
        data = prepare(line, self.names, self.reader.address_bytes or 1).encode("ascii", "replace") + b"\n"
        message = self.reader.read(self._now_s(), "sent", data)
        self.driver.send(data)
        return self._shown(message)

    def receive(self, timeout_s: float) -> Iterator[str]:
        """Yield the lines that came, if any, within `timeout_s`."""
        for piece in self._pieces.feed(self.driver.receive(timeout_s=timeout_s)):
            yield self._shown(self.reader.read(self._now_s(), "received", piece))

    def _now_s(self) -> float:
        return time.monotonic() - self._start_s

    def _shown(self, message: CaptureMessage) -> str:
        arrow = ">" if message.direction == "sent" else "<"
        return f"{arrow} {message.text:<28}  {message.meaning}"


def prepare(line: str, names: Names, address_bytes: int) -> str:
    """Replace names by addresses, and add a checksum to a line that begins with `$`.

    >>> prepare("$R:12", Names(None), 1), prepare("#rlc", Names(None), 1)
    ('$R:12*58', '#rlc')
    """
    line = line.strip()
    match = _LINE.match(line)
    if match is None:
        return line  # it is sent unchanged, and the device answers it
    head, letters, data, checksum = match.groups()
    if data is not None:
        data = _ADDRESS_OR_NAME.sub(lambda found: _digits(found[0], names, address_bytes), data)
        data = re.sub(r"[\s,]", "", data)
    text = head + letters + (f":{data}" if data is not None else "")
    if head == "$" and checksum is None:
        try:
            sent = ClassicEncoder(checked=True).encode(letters, bytes.fromhex(data or ""))
        except ValueError:  # these are not whole bytes; the device answers them
            return text
        checksum = sent.decode("ascii").strip()[-2:]  # computed over the letters as they were typed
    return text + (f"*{checksum}" if checksum else "")


def _digits(word: str, names: Names, address_bytes: int) -> str:
    element = names.elements.get(word)
    if element is not None:
        return f"{element.address:0{2 * address_bytes}X}"
    if re.fullmatch(r"[0-9A-Fa-f]+", word):
        return word
    from unitylink.spec.report.suggest import nearest

    meant = nearest(word, names.elements)
    raise ValueError(f"no name {word!r}" + (f"; did you mean {meant}?" if meant else ""))


def complete(text: str, names: Names) -> list[str]:
    """Return the possible completions of the last word of `text`.

    >>> complete("#RL", Names(None))
    ['RLC']
    """
    if ":" not in text:
        letters = text[1:].upper() if text[:1] in ("#", "$") else None
        return [command for command in _COMMANDS if letters is not None and command.startswith(letters)]
    word = re.split(r"[:\s,]", text)[-1]
    return [name for name in names.elements if name.startswith(word)]


def _script(session: Session, lines: Iterable[str]) -> None:
    for line in lines:
        if not line.strip():
            continue
        click.echo(_sent(session, line))
        end_s = time.monotonic() + _ANSWER_S
        answered = False
        while not answered and time.monotonic() < end_s:
            for shown in session.receive(end_s - time.monotonic()):
                click.echo(shown)
                answered = answered or not shown.startswith(("< %", "< &"))
        if not answered:
            click.echo(f"  (no answer in {_ANSWER_S:g} s)")


def _sent(session: Session, line: str) -> str:
    try:
        return session.send(line)
    except ValueError as error:
        raise Failure(str(error), "names are those of the spec (--spec FILE.ul)") from None


def _talk(session: Session, link: str) -> None:
    try:
        from prompt_toolkit import PromptSession
        from prompt_toolkit.completion import Completer, Completion
        from prompt_toolkit.patch_stdout import patch_stdout
    except ImportError:
        raise absent("prompt_toolkit", "typing commands") from None

    class Words(Completer):
        def get_completions(self, document, event):  # type: ignore[no-untyped-def]
            text = document.text_before_cursor
            begun = re.split(r"[#$:\s,]", text)[-1]
            for word in complete(text, session.names):
                yield Completion(word, start_position=-len(begun), display_meta=_COMMANDS.get(word, ""))

    click.echo(f"{link}\n{_HELP}")
    over = threading.Event()
    saying = threading.Lock()
    failures: list[LinkError] = []

    def listen(say: Callable[[str], None]) -> None:
        try:
            while not over.is_set():
                for shown in session.receive(0.1):
                    with saying:
                        say(shown)
        except LinkError as error:
            failures.append(error)
            say(f"the link has ended: {error}; Enter ends the terminal")

    with patch_stdout():
        listener = threading.Thread(target=listen, args=(print,), daemon=True)
        listener.start()
        prompt: PromptSession[str] = PromptSession(completer=Words(), complete_while_typing=False)
        try:
            while not failures:
                line = prompt.prompt("> ").strip()
                if line == ".quit":
                    break
                if line == ".help":
                    print(_HELP + "\n".join(_COMMANDS.values()))
                elif line:
                    try:
                        with saying:  # so that the answer is printed below it, however fast it comes
                            print(session.send(line))
                    except ValueError as error:
                        print(error)
        except (EOFError, KeyboardInterrupt):
            pass
        finally:
            over.set()
            listener.join()
    if failures:
        raise failures[0]
