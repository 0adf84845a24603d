# SPDX-License-Identifier: BSD-3-Clause
"""The constants of the wire protocols.

Generated from protocol/protocol.toml by protocol/generate.py; edit there.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

NAME: Final = "unity-link"
CLASSIC_VERSION: Final = 1

BYTE_PLAIN_HEAD: Final = 35
BYTE_CHECKED_HEAD: Final = 36
BYTE_PLAIN_PUBLISH: Final = 37
BYTE_CHECKED_PUBLISH: Final = 38
BYTE_ERROR_MARK: Final = 63
BYTE_DATA_MARK: Final = 58
BYTE_CHECKSUM_MARK: Final = 42
BYTE_LINE_FEED: Final = 10
BYTE_CARRIAGE_RETURN: Final = 13
BYTE_FIELD_SEPARATOR: Final = 44

CRC8_POLYNOMIAL: Final = 7
CRC8_INITIAL: Final = 0
CRC8_CHECK: Final = 244

COMMAND_READ: Final = "R"
COMMAND_READ_MANY: Final = "RM"
COMMAND_WRITE: Final = "W"
COMMAND_READ_CONFIGURATION: Final = "RLC"
COMMAND_WRITE_GROUP_ADDRESSES: Final = "WSA"
COMMAND_WRITE_GROUP_RATE: Final = "WSR"
COMMAND_READ_GROUP: Final = "RSI"
COMMAND_ENABLE_PUBLISHING: Final = "EPS"
COMMAND_ENABLE_CHECKED_PUBLISHING: Final = "EPC"
COMMAND_DISABLE_PUBLISHING: Final = "DPS"
COMMAND_WRITE_EVENT_MASK: Final = "WIC"
COMMAND_READ_EVENT_MASK: Final = "RIC"

REPLY_READ: Final = "S_R"
REPLY_READ_MANY: Final = "S_RM"
REPLY_WRITE: Final = "S_W"
REPLY_READ_CONFIGURATION: Final = "CNF"
REPLY_WRITE_GROUP_ADDRESSES: Final = "S_WSA"
REPLY_WRITE_GROUP_RATE: Final = "S_WSR"
REPLY_READ_GROUP: Final = "S_RSI"
REPLY_ENABLE_PUBLISHING: Final = "S_EPS"
REPLY_ENABLE_CHECKED_PUBLISHING: Final = "S_EPC"
REPLY_DISABLE_PUBLISHING: Final = "S_DPS"
REPLY_WRITE_EVENT_MASK: Final = "S_WIC"
REPLY_READ_EVENT_MASK: Final = "S_RIC"
REPLY_PUBLISH: Final = "PUB"

ADDRESS_BITS_MAX: Final = 32
DATA_BITS_MIN: Final = 8
DATA_BITS_MAX: Final = 32
READ_MANY_MAX: Final = 255
GROUPS_MAX: Final = 256
GROUP_SIZE_MAX: Final = 255
RATE_BYTES_MAX: Final = 4
GROUPS_2012: Final = 16
GROUP_SIZE_2012: Final = 32
FIFO_BYTES_DEFAULT: Final = 16
EVENT_MASK_BYTES_MIN: Final = 2
BUS_TIMEOUT_CLOCKS: Final = 100
CLOCK_HZ_DEFAULT: Final = 50000000
BASE_HZ_DEFAULT: Final = 1000

TOSNET_ADDRESS_BITS: Final = 11
TOSNET_MEMORY_WORDS: Final = 1024
TOSNET_NODE_SHIFT: Final = 6
TOSNET_REGISTER_SHIFT: Final = 3
TOSNET_IN_BIT: Final = 2
TOSNET_STATUS: Final = 1024
TOSNET_PACKET_COUNTER: Final = 1025
TOSNET_RESET_COUNTER: Final = 1026
TOSNET_ERROR_COUNTER: Final = 1027
TOSNET_NETWORK_REGISTERS: Final = 1280
TOSNET_ASYNC_TX_STATUS: Final = 1536
TOSNET_ASYNC_TX_CONTROL: Final = 1537
TOSNET_ASYNC_TX_DATA: Final = 1538
TOSNET_ASYNC_RX_STATUS: Final = 1792
TOSNET_ASYNC_RX_DATA: Final = 1794
TOSNET_STATUS_ONLINE_BIT: Final = 31
TOSNET_STATUS_MASTER_BIT: Final = 30
TOSNET_STATUS_PACKET_ERROR_BIT: Final = 29
TOSNET_STATUS_SYSTEM_HALT_BIT: Final = 28
TOSNET_STATUS_NETWORK_SYNC_BIT: Final = 27
TOSNET_STATUS_NODE_ID_SHIFT: Final = 20
TOSNET_STATUS_NODE_ADDRESS_SHIFT: Final = 16
TOSNET_STATUS_READ_ERROR_BIT: Final = 8
TOSNET_STATUS_WRITE_ERROR_BIT: Final = 7
TOSNET_STATUS_COMMIT_ABORTED_BIT: Final = 5
TOSNET_STATUS_READ_POINTER_BIT: Final = 3
TOSNET_STATUS_WRITE_POINTER_BIT: Final = 2
TOSNET_STATUS_READ_FROZEN_BIT: Final = 1
TOSNET_STATUS_COMMIT_PENDING_BIT: Final = 0

APPLICATION_ERRORS: Final = MappingProxyType(
    {
        "E_ICC": "unknown or unfinished command",
        "E_MAB": "address bytes missing",
        "E_MDB": "data, group, rate or mask bytes missing",
        "E_IBS": "read-many count 0 or too large",
        "E_ILA": "address count of a group 0 or too large",
        "E_ISG": "no such subscription group",
        "E_FBR": "bus error on read",
        "E_FBW": "bus error on write",
        "E_BAT": "nothing on the bus answered",
        "E_IPR": "a publish request vanished",
    }
)
APPLICATION_ERROR_INCOMPLETE_COMMAND: Final = "E_ICC"
APPLICATION_ERROR_MISSING_ADDRESS: Final = "E_MAB"
APPLICATION_ERROR_MISSING_DATA: Final = "E_MDB"
APPLICATION_ERROR_INVALID_BLOCK_SIZE: Final = "E_IBS"
APPLICATION_ERROR_INVALID_GROUP_SIZE: Final = "E_ILA"
APPLICATION_ERROR_INVALID_GROUP: Final = "E_ISG"
APPLICATION_ERROR_BUS_ERROR_READ: Final = "E_FBR"
APPLICATION_ERROR_BUS_ERROR_WRITE: Final = "E_FBW"
APPLICATION_ERROR_BUS_TIMEOUT: Final = "E_BAT"
APPLICATION_ERROR_PUBLISH_VANISHED: Final = "E_IPR"

DATALINK_ERRORS: Final = MappingProxyType(
    {
        240: "message too long for the receive buffer",
        241: "framing character where none may stand",
        242: "odd number of hex digits",
        243: "invalid character",
        244: "checksum wrong or missing",
        245: "plus 1 parity, 2 framing, 4 overrun: error of the physical layer",
    }
)
DATALINK_ERROR_MESSAGE_TOO_LONG: Final = 240
DATALINK_ERROR_FORMAT: Final = 241
DATALINK_ERROR_ODD_DIGITS: Final = 242
DATALINK_ERROR_INVALID_CHARACTER: Final = 243
DATALINK_ERROR_CHECKSUM: Final = 244
DATALINK_ERROR_PHYSICAL: Final = 245
