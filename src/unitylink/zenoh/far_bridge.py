# SPDX-License-Identifier: BSD-3-Clause
"""A bridge, as a client sees it: greeted, asked, and asked again until it answers or the time is over."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from unitylink.errors import (
    DeviceMismatch,
    LinkClosed,
    LinkDown,
    LinkTimeout,
    OutcomeUnknown,
    ProtocolError,
    UnityLinkError,
    ValueRangeError,
)

from .far_clock import FarClock
from .far_greeting import LOOK_S, FarGreeting
from .far_questions import PAUSE_S, FarQuestions
from .messages import ARM, CLOCK, DO, LEAVE, VISIT, Answer, Operation, Request, decode_answer

if TYPE_CHECKING:
    import zenoh

    from .far_options import FarOptions

_CLOCK_S = 0.5  # how often its clock is asked, and whether it still knows this client
_GREET_S = 6.0  # how long a bridge whose board is there has to answer the first hello


class FarBridge:
    """The bridge of one robot. It is greeted again when it, or its board, comes back.

    `changed(kind, text)` is told of `lost` and `back`. Raises LinkNotFound if nobody serves the name, and
    DeviceMismatch if two bridges do.
    """

    def __init__(self, options: FarOptions, changed: Callable[[str, str], None]) -> None:
        self.options, self.keys = options, options.keys
        self.session: zenoh.Session = options.network.opened()
        self.questions = FarQuestions(self.session, self.keys, self._broken)
        self._greeting = FarGreeting(options, self.session, self.questions)
        self.clock = FarClock()
        self.configuration: dict[str, Any] = {}
        self.hash = ""
        self.bridge, self.visit = "", 0
        self.generation = 0
        self.trouble, self.closed = "", False
        self._ended = False  # by itself
        self.counts = dict.fromkeys(("requests", "replies", "retries", "timeouts"), 0)
        self._changed = changed
        self._lock = threading.Lock()  # guards the requests that are open, and the greeting
        self._last = 0
        self._open: set[int] = set()
        self._boards: set[str] = set()  # whose tokens are there
        self._look = threading.Condition()
        self._half = False  # whether what belongs to the greeting is not complete
        self._doubt = False  # whether the keeper has to look at once
        self._token: zenoh.LivelinessToken | None = None
        self._answered_generation = 0
        try:
            self._watch = self.session.liveliness().declare_subscriber(
                self.keys.board("*"), self._heard_board
            )
            self._greet_first()
        except BaseException:
            self.session.close()
            raise
        self._keeper = threading.Thread(target=self._keep, name="zenoh client", daemon=True)
        self._keeper.start()

    def close(self, why: str = "the link is closed") -> None:
        """Say goodbye, so that the outputs keep their values, and close the session."""
        with self._look:
            over, self.closed = self.closed, True
            self._look.notify_all()
        if not (over or self.trouble):
            with contextlib.suppress(UnityLinkError):
                self._ask(LEAVE, attempts=1)
        self.trouble = self.trouble or why
        if threading.current_thread() is not self._keeper:
            self._keeper.join()
        if not over:  # else the keeper has closed it, or it belongs to the parent of this process
            with contextlib.suppress(Exception):
                self.session.close()

    def check(self) -> None:
        """Raises LinkClosed after the end, and LinkDown while the board is gone."""
        if self.closed or self.trouble:
            raise self._broken(self.trouble)

    def _broken(self, why: str) -> UnityLinkError:
        if self.closed:
            return LinkClosed(f"{self.options.url}: {self.trouble or 'the link is closed'}")
        return LinkDown(f"{self.options.url}: {why}")

    def greet_again(self) -> None:
        """Say hello anew, as a new client: something of the last greeting did not get through."""
        with self._look:
            self._half = True
            self._look.notify_all()

    # ---- requests

    def ask(
        self,
        kind: int = DO,
        operations: Sequence[Operation] = (),
        *,
        flags: int = 0,
        argument: int = 0,
        detail: int = 0,
        timeout_s: float | None = None,
    ) -> tuple[int, ...]:
        """Ask, and return the words of the answer.

        Raises LinkTimeout, or OutcomeUnknown if the request must not be repeated, or the error of the bridge.
        """
        self.check()
        return self._ask(
            kind, operations, flags=flags, argument=argument, detail=detail, timeout_s=timeout_s
        ).words

    def _ask(
        self,
        kind: int,
        operations: Sequence[Operation] = (),
        *,
        flags: int = 0,
        argument: int = 0,
        detail: int = 0,
        timeout_s: float | None = None,
        attempts: int | None = None,
    ) -> Answer:
        each_s = self.options.timeout_s if timeout_s is None else timeout_s
        attempts = attempts or self.options.attempts
        began_ns = time.monotonic_ns()
        with self._lock:
            self._last += 1
            number = self._last
            self._open.add(number)
            settled = min(self._open)
            key, visit = self.keys.request(self.bridge), self.visit
        deadline_ns = self.clock.deadline(began_ns, int(each_s * attempts * 1e9))
        if kind == ARM:  # the bridge refuses it if somebody has stopped the robot since
            before_us = (deadline_ns - self.clock.latest(began_ns)) // 1000
            argument = min(max(before_us, 1), 0xFFFFFFFF)
        request = Request(
            kind, visit, number, settled, deadline_ns, flags, argument, detail, tuple(operations)
        )
        try:
            return self._attempts(key, request, each_s, attempts, began_ns)
        finally:
            with self._lock:
                self._open.discard(number)

    def _attempts(self, key: str, request: Request, each_s: float, attempts: int, began_ns: int) -> Answer:
        try:
            data = request.encode()
        except Exception:  # struct.error: a number that no word holds
            raise ValueRangeError("an address or a value is no number of 32 bits; nothing was sent") from None
        sent = 0  # copies that may have reached the bridge
        until_ns = began_ns + int(each_s * attempts * 1e9)
        self.counts["requests"] += 1
        while (left_ns := until_ns - time.monotonic_ns()) > 0:
            self.counts["retries"] += sent > 0
            answer = self.questions.once(key, data, min(each_s, left_ns / 1e9))
            if isinstance(answer, bytes):
                self.counts["replies"] += 1
                return self._checked(decode_answer(answer), request)
            if answer is not None:
                if isinstance(answer, LinkDown):
                    self._look_now()
                if isinstance(answer, (LinkDown, LinkClosed)) and sent and request.once:
                    break  # an earlier copy may have been executed, for a visit that has ended
                raise answer
            reached = self.questions.reached
            # A copy whose way is lost after it has arrived looks like one for which nobody was there.
            sent += reached or request.once
            if not reached:
                if self.trouble and not self.closed:
                    break
                time.sleep(PAUSE_S)
        elapsed_s = (time.monotonic_ns() - began_ns) / 1e9
        self.counts["timeouts"] += 1
        facts: dict[str, Any] = {"attempts": sent, "elapsed_s": elapsed_s}
        if request.operations:
            facts["address"] = request.operations[0][1]
        if not sent:
            raise LinkDown(f"{self.options.url}: no bridge is there; nothing was executed", **facts)
        if request.once:
            raise OutcomeUnknown(
                f"{self.options.url}: no answer to {sent} copies of a request; it was executed once or never",
                **facts,
            )
        raise LinkTimeout(f"{self.options.url}: no answer after {elapsed_s:.2g} s", **facts)

    def _checked(self, answer: Answer, request: Request) -> Answer:
        if answer.id != request.id:
            raise ProtocolError(f"an answer to the request {answer.id} instead of {request.id}")
        if request.kind != LEAVE and answer.generation != self._answered_generation:
            self.generation += self._answered_generation != 0
            self._answered_generation = answer.generation
        return answer

    # ---- the greeting

    def _greet(self) -> None:
        """Find the one bridge whose board is there, and say hello to it."""
        boards = self._greeting.find()
        with self._look:
            self._boards = set(boards)
        welcome = self._greeting.greet(boards, self.hash)
        old, self._token, told = self._token, welcome.token, welcome.told
        with self._lock:
            self.clock = FarClock()
            self.clock.learn(welcome.asked_ns, told["now_ns"], welcome.heard_ns)
            self.visit, self.bridge, self.hash = told["visit"], told["bridge"], told["hash"]
            self.configuration = told["configuration"]
        if old is not None:
            old.undeclare()

    def _greet_first(self) -> None:
        """Greet until the bridge has time for it. Many clients may come at the same time."""
        until_s = time.monotonic() + _GREET_S
        while True:
            try:
                return self._greet()
            except LinkTimeout:
                if time.monotonic() > until_s:
                    raise

    def _look_now(self) -> None:
        with self._look:
            self._doubt = True
            self._look.notify_all()

    def _heard_board(self, sample: zenoh.Sample) -> None:
        import zenoh

        board = str(sample.key_expr).rpartition("/")[2]
        with self._look:
            (self._boards.add if sample.kind == zenoh.SampleKind.PUT else self._boards.discard)(board)
            self._look.notify_all()

    def _keep(self) -> None:
        """Follow the tokens of boards, and the clock of the bridge."""
        greeted = True
        while not self.closed and threading.main_thread().is_alive():
            with self._look:
                boards, self._doubt = set(self._boards), False
                greeted, self._half = greeted and not self._half, False
            if boards == {self.bridge} and greeted:
                if self.trouble:  # another robot of the name has gone
                    self._tell("")
                answer = self._ask_clock()
                if isinstance(answer, UnityLinkError):
                    # Both were off the network. To this side, the board looks as if nothing had been.
                    greeted = self._greet_again(f"the visit has ended: {answer}")
                elif not answer:
                    found = self._greeting.boards()  # a token that went unnoticed
                    with self._look:
                        self._boards = found
            elif len(boards) > 1:
                self._tell(f"{len(boards)} robots have the name {self.keys.name} on this network")
            elif not boards:
                greeted = False
                self._tell("the board, its bridge or the way to it is gone")
            else:
                greeted = self._greet_again("the board is back, and is being greeted")
            with self._look:
                if boards == self._boards and not (self.closed or self._doubt or self._half):
                    self._look.wait(_CLOCK_S if greeted else PAUSE_S * 5)
        if not self.closed:
            self._end("the program has ended")
        if self._ended:  # nobody else closes the session, whose threads let no program end
            with contextlib.suppress(Exception):
                self.session.close()

    def _end(self, why: str) -> None:
        """The link is over, though nobody has closed it. The keeper calls this."""
        self.closed = self._ended = True
        self._changed("ended", why)

    def _greet_again(self, why: str) -> bool:
        self._tell(why)
        try:
            self._greet()
        except DeviceMismatch as error:
            self._tell(str(error))
            self._end(str(error))
            return False
        except UnityLinkError as error:
            self._tell(str(error))
            return False
        self.generation += 1
        self._tell("")
        return True

    def _tell(self, trouble: str) -> None:
        before, self.trouble = self.trouble, trouble
        if bool(before) == bool(trouble):
            return
        if trouble and not self.options.reconnect:
            self._end(trouble)
        else:
            self._changed("lost" if trouble else "back", trouble or "the board is back")

    def _ask_clock(self) -> bool | UnityLinkError:
        """Ask for the clock. Return whether this bridge has answered, or the error that it answers."""
        asked_ns = time.monotonic_ns()
        answer = self.questions.once(self.keys.fixed("clock"), VISIT.pack(self.visit), LOOK_S)
        heard_ns = time.monotonic_ns()
        if isinstance(answer, bytes) and len(answer) == CLOCK.size:
            bridge, told_ns = CLOCK.unpack(answer)
            if bridge == int(self.bridge, 16):
                self.clock.learn(asked_ns, told_ns, heard_ns)
                return True
        return answer if isinstance(answer, UnityLinkError) and self.questions.reached else False
