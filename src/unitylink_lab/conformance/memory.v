// SPDX-License-Identifier: BSD-3-Clause
// The memory of a replay, as gateware/test/bench_memory.vhd has it: it answers in the next clock. With RECORDED, word a
// starts as 0x40DE0000 | (a * 257 & 0xFFFF), the top bytes E0 to EF are refused, and F0 to FF do not answer. If BAD is
// not 0, four words from there are refused, and the next four do not answer.
module replay_memory #(
  parameter ADDRESS_BITS = 8, parameter PORT_BITS = 8, parameter DATA_BITS = 32,
  parameter RECORDED = 1, parameter BAD = 0
) (
  input clock,
  input strobe, input write, input [PORT_BITS - 1:0] address,
  input [DATA_BITS - 1:0] given, output reg [DATA_BITS - 1:0] word, output reg done, output reg refused
);
  localparam INDEX_BITS = ADDRESS_BITS < 16 ? ADDRESS_BITS : 16;
  reg [DATA_BITS - 1:0] memory [0:(1 << INDEX_BITS) - 1];
  reg [31:0] first;
  integer a;

  initial begin
    for (a = 0; a < 1 << INDEX_BITS; a = a + 1) begin
      first = 32'h40DE0000 | (a * 257 & 32'hFFFF);
      memory[a] = RECORDED ? first[DATA_BITS - 1:0] : 0;
    end
    word = 0;
    done = 0;
    refused = 0;
  end

  wire [INDEX_BITS - 1:0] index = address[INDEX_BITS - 1:0];
  wire [7:0] top = address[PORT_BITS - 1:PORT_BITS - 8];
  wire silent = RECORDED & top >= 8'hF0 | BAD > 0 & index >= BAD + 4 & index < BAD + 8;
  wire bad = RECORDED & top >= 8'hE0 | BAD > 0 & index >= BAD & index < BAD + 4;

  always @(posedge clock) begin
    done <= 0;
    refused <= 0;
    if (strobe & ~done & ~refused & ~silent) begin
      done <= ~bad;
      refused <= bad;
      word <= memory[index];
      if (write & ~bad) memory[index] <= given;
    end
  end
endmodule
