// SPDX-License-Identifier: BSD-3-Clause
// A master on the bus of the SoC that LiteX made of examples/litex: our slaves behind LiteX's interconnect.
`timescale 1ns / 1ps

module litex_bench;
  localparam logic [31:0] BASE = 32'h9000_0000;  // of our slaves, in bytes
  localparam logic [31:0] PENDING = 32'h0000_0804;  // of LiteX's event manager, in csr.csv
  localparam logic [31:0] ENABLE = 32'h0000_0808;

  logic clock = 0, reset = 1;
  logic cyc = 0, stb = 0, we = 0;
  logic [29:0] adr = 0;
  logic [31:0] to_slave = 0;
  wire [31:0] from_slave;
  wire ack, err;
  logic [7:0] level = 0, drives = 0;
  wire [7:0] pins;

  for (genvar n = 0; n < 8; n++) begin : g_pin
    assign pins[n] = drives[n] ? level[n] : 1'bz;
  end

  soc soc (
    .clk(clock), .rst(reset), .pmoda(pins),
    .master_cyc(cyc), .master_stb(stb), .master_we(we), .master_adr(adr), .master_dat_w(to_slave), .master_sel(4'hF),
    .master_cti(3'b0), .master_bte(2'b0), .master_dat_r(from_slave), .master_ack(ack), .master_err(err));

  always #10 clock = ~clock;

  // An access of the byte address. It ends with `failed` if the bus says so.
  task automatic access(input logic [31:0] at, input logic writes, input logic [31:0] value, output logic [31:0] got,
                        output logic failed);
    @(posedge clock) #1;
    cyc = 1; stb = 1; we = writes; adr = at[31:2]; to_slave = value;
    do @(negedge clock); while (!(ack || err));
    got = from_slave;
    failed = err;
    @(posedge clock) #1;  // the clock of the answer ends here
    cyc = 0; stb = 0;
  endtask

  task automatic write(input logic [31:0] at, input logic [31:0] value);
    logic [31:0] got; logic failed;
    access(at, 1, value, got, failed);
    if (failed) $fatal(1, "a write to %h failed", at);
  endtask

  task automatic expect_word(input logic [31:0] at, input logic [31:0] value);
    logic [31:0] got; logic failed;
    access(at, 0, 0, got, failed);
    if (failed) $fatal(1, "a read of %h failed", at);
    if (got != value) $fatal(1, "%h has %h instead of %h", at, got, value);
  endtask

  logic [31:0] got;
  logic failed;

  initial begin
    repeat (10) @(negedge clock);
    reset = 0;
    write(BASE + 4 * 1, 32'h0000_00A5);  // outputs
    expect_word(BASE + 4 * 1, 32'h0000_00A5);
    write(BASE + 4 * 2, 32'h0000_000F);  // the lower four drive their pins
    repeat (4) @(negedge clock);
    if (pins[3:0] != 4'h5) $fatal(1, "the pins have %h", pins);
    drives = 8'hF0; level = 8'h90;  // the others are inputs
    repeat (8) @(negedge clock);
    expect_word(BASE, 32'h0000_0095);

    expect_word(PENDING, 0);
    write(BASE + 4 * 5, 32'h0000_0080);  // watch a pin
    write(BASE + 4 * 9, 32'h0000_0001);  // its change interrupts
    write(ENABLE, 1);
    expect_word(PENDING, 0);
    level = 8'h10;
    repeat (12) @(negedge clock);
    expect_word(BASE + 4 * 8, 1);
    expect_word(PENDING, 1);
    write(BASE + 4 * 8, 1);
    repeat (4) @(negedge clock);
    expect_word(PENDING, 0);

    access(BASE + 4 * 64, 0, 0, got, failed);  // no slave is there
    if (!failed) $fatal(1, "an address without a slave was answered");
    $display("litex_bench: passed");
    $finish;
  end

  initial begin
    #100000 $fatal(1, "no end in time");
  end
endmodule
