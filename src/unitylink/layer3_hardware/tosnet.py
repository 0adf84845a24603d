# SPDX-License-Identifier: BSD-3-Clause
"""TosNet, the paper's real-time network between FPGAs: a shared memory of up to 15 nodes, status, commits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

from unitylink import protocol
from unitylink.errors import (
    DeviceMismatch,
    LinkTimeout,
    NetworkError,
    NetworkHalted,
    NetworkOffline,
    ValueRangeError,
    shown,
)

from .arguments import at, positive, whole
from .committed import CommittedProxy
from .tosnet_async import TosNetAsync
from .tosnet_events import NetworkCallback, NetworkListener, NetworkWatch, lost
from .tosnet_status import NetworkNode, TosNetCounters, TosNetStatus

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

NODES = 16
REGISTERS_PER_NODE = 8
WORDS_PER_REGISTER = 4
WORD_BITS = 32
_ONLINE = 1 << protocol.TOSNET_STATUS_ONLINE_BIT
_HALTED = 1 << protocol.TOSNET_STATUS_SYSTEM_HALT_BIT
_ABORTED = 1 << protocol.TOSNET_STATUS_COMMIT_ABORTED_BIT
_PENDING = 1 << protocol.TOSNET_STATUS_COMMIT_PENDING_BIT


class TosNetProxy(CommittedProxy):
    """Give access to a TosNet network behind the gateware.

    Register `r` of node `n` has four OUT words, which the node writes, and four IN words, which it obeys.
    `read` and `write` take the word address (node * 64 + register * 8 + 4 if IN + word).
    `node(n).register(r)` computes it.

    A commit takes effect at the next network cycle. A write waits for this. It raises NetworkError if the
    network is offline or halted, or if it dropped the commit. `control` is the link for status and commits,
    by default the same one (CTRL in a UL-spec).

    >>> network = TosNetProxy(link)                                   # doctest: +SKIP
    >>> network.node(2).register(1).inputs[0] = 1000   # one burst, one commit  # doctest: +SKIP
    >>> network.node(2).register(1).outputs[0]                        # doctest: +SKIP
    998
    """

    kind = "tosnet"
    commit_address = protocol.TOSNET_STATUS
    pending_bits = (_ONLINE | _HALTED | _PENDING, _ONLINE | _PENDING)

    def __init__(self, link: Link, base: int = 0, *, control: Link | None = None) -> None:
        super().__init__(link, base, words=1 << protocol.TOSNET_ADDRESS_BITS, control=control)
        bits = self.control.configuration.data_bits
        if bits != WORD_BITS:
            raise DeviceMismatch(
                f"{self.control.url} has words of {bits} bits, a TosNet module of {WORD_BITS}: "
                "this is not the board the spec is for"
            )
        self._async = TosNetAsync(self.control, base)

    def node(self, node_id: int) -> TosNetNode:
        """Return the node 1-15. Node 0 exists if the gateware uses it."""
        return TosNetNode(self, node_id)

    def status(self) -> TosNetStatus:
        """Read and decode the status word."""
        return TosNetStatus.decode(self.control.read(self.base + protocol.TOSNET_STATUS))

    def counters(self) -> TosNetCounters:
        """Read the packet, reset and error counters."""
        first = protocol.TOSNET_PACKET_COUNTER
        where = (first, protocol.TOSNET_RESET_COUNTER, protocol.TOSNET_ERROR_COUNTER)
        packets, resets, errors = (int(w) for w in self.control.read_many([self.base + a for a in where]))
        return TosNetCounters(packets, resets, errors)

    def nodes(self) -> tuple[NetworkNode, ...]:
        """Read the list of the nodes that are in the ring, in ring order."""
        first = self.base + protocol.TOSNET_NETWORK_REGISTERS
        words = self.control.read_many(range(first, first + NODES))
        return NetworkNode.decode_list([int(word) for word in words])

    def check_nodes(self, *node_ids: int) -> None:
        """Raise NodeLost if one of these nodes is not in the ring. The error names all that are not."""
        there = {node.node_id for node in self.nodes()}
        if missing := sorted({whole("tosnet: node", node) for node in node_ids} - there):
            raise lost(missing, self.base + protocol.TOSNET_NETWORK_REGISTERS)

    def watch(self, nodes: Iterable[int] = ()) -> NetworkWatch:
        """Return a watch. Its `look()` tells what has happened. `nodes` are the ids that should be there."""
        return NetworkWatch(self, nodes)

    def on_event(
        self, callback: NetworkCallback, *, nodes: Iterable[int] = (), period_s: float = 0.1
    ) -> Callable[[], None]:
        """Call `callback(event)` when the network is cut or mended, halts, loses a node or gets one back.

        The network is looked at every `period_s`, in a thread of its own. Call the result to end this.

        >>> end = network.on_event(lambda event: print(event.kind, event.text))   # doctest: +SKIP
        """
        if not callable(callback):
            raise ValueRangeError(f"tosnet: {shown(callback)} is not a function")
        return NetworkListener(self.watch(nodes), callback, positive("tosnet: period_s", period_s)).close

    def async_send(self, node_id: int, data: bytes, *, timeout_s: float = 0.5) -> None:
        """Send bytes to a node (0 = all) over the asynchronous channel.

        Raises LinkTimeout if the channel stays full.
        """
        self._async.send(node_id, data, timeout_s)

    def async_receive(self) -> list[tuple[int, bytes]]:
        """Return the messages of the asynchronous channel, oldest first, as (sender's node id, bytes)."""
        return self._async.receive()

    def _check_output(self, address: int) -> None:
        if not 0 <= address < protocol.TOSNET_MEMORY_WORDS:
            raise ValueRangeError(
                f"tosnet: {at(address)} is not in the shared memory, "
                f"0 to {protocol.TOSNET_MEMORY_WORDS - 1:#x}; "
                "commits and the asynchronous channel have methods of their own"
            )

    def _settle(self, patience_s: float, *, committed: bool, status: int | None = None) -> None:
        started, polls = 0.0, 0
        while True:
            word = self.control.read(self.base + protocol.TOSNET_STATUS) if status is None else status
            polls, status = polls + 1, None
            if word & (_ONLINE | _HALTED) != _ONLINE:
                raise self._down(TosNetStatus.decode(word), committed)
            if not word & _PENDING:
                break
            now = self.control.now_s()
            started = now if polls == 1 else started
            if now >= started + patience_s:
                what = "this write takes effect when it does" if committed else "nothing was written"
                raise LinkTimeout(
                    f"a commit is still pending after {(now - started) * 1e3:.0f} ms "
                    f"({TosNetStatus.decode(word)}); the network does not cycle; {what}",
                    address=self.base + protocol.TOSNET_STATUS,
                    attempts=polls,
                    elapsed_s=now - started,
                )
            self.control.pause_between_looks()
        if committed and word & _ABORTED:
            raise NetworkError(
                "the commit was aborted: another program wrote to the network's memory while it was pending; "
                "nothing of this write took effect. Write again (or commit())",
                address=self.base + protocol.TOSNET_STATUS,
            )

    def _down(self, status: TosNetStatus, committed: bool) -> NetworkError:
        what = "is halted until its reset" if status.system_halt else "is offline"
        pending = committed and status.commit_pending
        effect = "this write takes effect when it is back" if pending else "outputs take no effect"
        if status.other_spec:
            what = (
                f"is refused: node {status.other_spec} was built from another spec. Generate its VHDL from "
                "this spec, build it and load it"
            )
        kind = NetworkHalted if status.system_halt else NetworkOffline
        return kind(
            f"the TosNet network {what} ({status}); {effect}", address=self.base + protocol.TOSNET_STATUS
        )


class TosNetNode:
    """One node of the network. Iterating over it gives its registers."""

    def __init__(self, network: TosNetProxy, node_id: int) -> None:
        node_id = whole("tosnet: node", node_id)
        if not 0 <= node_id < NODES:
            raise ValueRangeError(f"tosnet: node {shown(node_id)} is not in 0..{NODES - 1}")
        self.network = network
        self.node_id = node_id

    def register(self, number: int) -> TosNetRegister:
        """Return register 0-7 of the node."""
        return TosNetRegister(self, number)

    def __iter__(self) -> Iterator[TosNetRegister]:
        return (self.register(number) for number in range(REGISTERS_PER_NODE))


class TosNetRegister:
    """A register: the node writes `outputs[0..3]` and obeys `inputs[0..3]`."""

    def __init__(self, node: TosNetNode, number: int) -> None:
        number = whole("tosnet: register", number)
        if not 0 <= number < REGISTERS_PER_NODE:
            raise ValueRangeError(f"tosnet: register {shown(number)} is not in 0..{REGISTERS_PER_NODE - 1}")
        first = node.node_id << protocol.TOSNET_NODE_SHIFT | number << protocol.TOSNET_REGISTER_SHIFT
        self.outputs = TosNetWords(node.network, first)
        self.inputs = TosNetWords(node.network, first | 1 << protocol.TOSNET_IN_BIT)


class TosNetWords:
    """Four words of a register. `words[2]` reads, `words[2] = 5` writes and commits (or joins a batch)."""

    def __init__(self, network: TosNetProxy, first: int) -> None:
        self.network = network
        self.first = first

    def address(self, word: int) -> int:
        """Return the word's address relative to the network's base."""
        word = whole("tosnet: word", word)
        if not 0 <= word < WORDS_PER_REGISTER:
            raise ValueRangeError(f"tosnet: word {shown(word)} is not in 0..{WORDS_PER_REGISTER - 1}")
        return self.first + word

    def __getitem__(self, word: int) -> int:
        return self.network.read(self.address(word))

    def __setitem__(self, word: int, value: int) -> None:
        self.network.write(self.address(word), value)

    def __len__(self) -> int:
        return WORDS_PER_REGISTER

    def __iter__(self) -> Iterator[int]:
        words = self.network.read_many(range(self.first, self.first + WORDS_PER_REGISTER), atomic=True)
        return iter([int(word) for word in words])
