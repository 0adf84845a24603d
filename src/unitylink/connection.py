# SPDX-License-Identifier: BSD-3-Clause
"""connect(url): a Link to a board over a port, or to a virtual board made on the spot."""

from __future__ import annotations

from unitylink.errors import UrlError
from unitylink.layer2_message import Link


def connect(url: str) -> Link:
    """Return an open Link to the device that `url` names.

        connect("serial:/dev/ttyUSB0?baud=3000000")
        connect("tcp://192.168.1.10:5555?crc=1&fifo=1024")
        connect("sim:examples/scara/scara.ul?plant=scara")     # a virtual board in this process
        connect("rtl:examples/scara/scara.ul?plant=scara")     # the same, but the VHDL itself, compiled

    Options: `timeout=0.1` (s per attempt), `attempts=3`, `fifo=16` or `fifo=RX,TX` (bytes of the device's
    buffers), `crc=0|1`, `publish_crc=1`, `polynomial=0x07`, `window=64`, `gateware=auto|2012|corrected`,
    `trace=FILE` (a capture of all bytes, for `unitylink decode` and Wireshark).
    Where gateware has no RLC also `address_bytes= data_bytes= read_many= publish_mode= base_hz= groups=
    group_size= rate_bytes=`.

    Raises UrlError, LinkNotFound, LinkBusy, LinkTimeout (nothing answers), DeviceMismatch.
    """
    if url.startswith(("sim:", "rtl:")):
        from unitylink.simulate import simulated_board

        board, link_url = simulated_board(url)
        try:
            link = Link(link_url)
        except UrlError as error:
            board.close()
            raise UrlError(str(error).replace(link_url, url)) from None
        except BaseException:
            board.close()
            raise
        link.url = url
        link.board = board
        link.call_on_close(board.close)
        return link
    return Link(url)
