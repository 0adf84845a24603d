// SPDX-License-Identifier: BSD-3-Clause
// Models of an iCE40's blocks, and of what is at its pins. All have one clock.

// The block RAM, 4096 bits. Its modes are 256 x 16, 512 x 8, 1024 x 4 and 2048 x 2 bits. A narrow word has the first
// bits of each group of the 16, and the upper bits of the address choose the place within a group. It reads what was
// there before a write in the same clock.
module unitylink_ram40 #(
  parameter READ_MODE = 0,
  parameter WRITE_MODE = 0,
  parameter INIT_0 = 256'h0, parameter INIT_1 = 256'h0, parameter INIT_2 = 256'h0, parameter INIT_3 = 256'h0,
  parameter INIT_4 = 256'h0, parameter INIT_5 = 256'h0, parameter INIT_6 = 256'h0, parameter INIT_7 = 256'h0,
  parameter INIT_8 = 256'h0, parameter INIT_9 = 256'h0, parameter INIT_A = 256'h0, parameter INIT_B = 256'h0,
  parameter INIT_C = 256'h0, parameter INIT_D = 256'h0, parameter INIT_E = 256'h0, parameter INIT_F = 256'h0
) (
  input clock,
  input [10:0] WADDR, input [10:0] RADDR,
  input [15:0] MASK, input [15:0] WDATA, output [15:0] RDATA,
  input WE, input WCLKE, input RE, input RCLKE
);
  localparam [4095:0] FIRST = {INIT_F, INIT_E, INIT_D, INIT_C, INIT_B, INIT_A, INIT_9, INIT_8,
                               INIT_7, INIT_6, INIT_5, INIT_4, INIT_3, INIT_2, INIT_1, INIT_0};
  reg [15:0] memory [0:255];
  reg [15:0] word;
  reg [2:0] place;
  integer index;

  initial begin
    for (index = 0; index < 256; index = index + 1) memory[index] = FIRST[16 * index +: 16];
    word = 0;
    place = 0;
  end

  localparam [2:0] WIDE = (1 << WRITE_MODE) - 1, READ_WIDE = (1 << READ_MODE) - 1;
  wire [2:0] write_place = WADDR[10:8] & WIDE;
  wire [15:0] kept, given;
  generate
    if (WRITE_MODE == 0) begin : write_16
      assign kept = MASK;
      assign given = WDATA;
    end else if (WRITE_MODE == 1) begin : write_8
      assign kept = ~(16'h5555 << write_place);
      assign given = {{2{WDATA[14]}}, {2{WDATA[12]}}, {2{WDATA[10]}}, {2{WDATA[8]}},
                      {2{WDATA[6]}}, {2{WDATA[4]}}, {2{WDATA[2]}}, {2{WDATA[0]}}};
    end else if (WRITE_MODE == 2) begin : write_4
      assign kept = ~(16'h1111 << write_place);
      assign given = {{4{WDATA[13]}}, {4{WDATA[9]}}, {4{WDATA[5]}}, {4{WDATA[1]}}};
    end else begin : write_2
      assign kept = ~(16'h0101 << write_place);
      assign given = {{8{WDATA[11]}}, {8{WDATA[3]}}};
    end
    if (READ_MODE == 0) begin : read_16
      assign RDATA = word;
    end else if (READ_MODE == 1) begin : read_8
      assign RDATA = word >> place & 16'h5555;
    end else if (READ_MODE == 2) begin : read_4
      assign RDATA = (word >> place & 16'h1111) << 1;
    end else begin : read_2
      assign RDATA = (word >> place & 16'h0101) << 3;
    end
  endgenerate

  always @(posedge clock) begin
    if (RE & RCLKE) begin
      word <= memory[RADDR[7:0]];
      place <= RADDR[10:8] & READ_WIDE;
    end
    if (WE & WCLKE) memory[WADDR[7:0]] <= memory[WADDR[7:0]] & kept | given & ~kept;
  end
endmodule

// The lock of the PLL: it comes some time after power-up.
module unitylink_lock (input clock, output lock);
  reg [6:0] waited = 0;
  assign lock = waited[6];
  always @(posedge clock) if (!lock) waited <= waited + 1;
endmodule

// The far end of a serial line: a UART with 8 data bits and a stop bit, as in an FTDI chip. After power-up it waits
// POWER_UP clocks before it sends, because no PC is faster than the configuration of a chip. It drops a byte that has
// no stop bit, and one for which there is no room.
module unitylink_line #(
  parameter CLOCK_HZ = 12000000,
  parameter BAUD_HZ = 1000000,
  parameter POWER_UP = 6000
) (
  input clock, input reset,
  output to_chip, input from_chip,
  input rx_valid, output rx_ready, input [7:0] rx_data,
  output tx_valid, input tx_ready, output [7:0] tx_data
);
  reg [31:0] waited = 0;
  reg [9:0] sending = 10'h3ff;
  reg [3:0] left = 0;
  reg [31:0] sent_part = 0;
  wire sent_bit = sent_part >= CLOCK_HZ - BAUD_HZ;

  assign to_chip = sending[0];
  assign rx_ready = left == 0 & waited >= POWER_UP;

  always @(posedge clock) begin
    if (reset) waited <= 0;
    else if (waited < POWER_UP) waited <= waited + 1;
    if (reset) begin
      sending <= 10'h3ff;
      left <= 0;
    end else if (left == 0) begin
      sent_part <= 0;
      if (rx_valid & rx_ready) begin
        sending <= {1'b1, rx_data, 1'b0};
        left <= 10;
      end
    end else begin
      sent_part <= sent_bit ? sent_part + BAUD_HZ - CLOCK_HZ : sent_part + BAUD_HZ;
      if (sent_bit) begin
        sending <= {1'b1, sending[9:1]};
        left <= left - 1;
      end
    end
  end

  reg [8:0] came = 0;
  reg [3:0] wanted = 0;
  reg [31:0] came_part = 0;
  reg full = 0, line = 1;
  reg [7:0] kept = 0;
  wire came_bit = came_part >= CLOCK_HZ - BAUD_HZ;

  assign tx_valid = full;
  assign tx_data = kept;

  always @(posedge clock) begin
    line <= from_chip;
    if (tx_ready) full <= 0;
    if (reset) begin
      wanted <= 0;
      full <= 0;
    end else if (wanted == 0) begin
      came_part <= CLOCK_HZ / 2;  // bits are sampled in their middle
      if (line & ~from_chip) wanted <= 10;
    end else begin
      came_part <= came_bit ? came_part + BAUD_HZ - CLOCK_HZ : came_part + BAUD_HZ;
      if (came_bit) begin
        came <= {from_chip, came[8:1]};
        wanted <= wanted == 10 & from_chip ? 0 : wanted - 1;  // a short pulse is no start bit
        if (wanted == 1 & from_chip & (~full | tx_ready)) begin
          full <= 1;
          kept <= came[8:1];
        end
      end
    end
  end
endmodule

// A block RAM of an ECP5: 2048 entries of 9 bits, and two ports. A port of 36 or 18 bits has several entries, and the
// lowest bits of its address are then its byte enables. A port of 4, 2 or 1 bits has a part of the lowest 8 bits. Mode
// 0 keeps the output in a write, 1 shows what is written, 2 what was there before. With 36 bits there is one memory
// that port A writes and port B reads, and the upper 18 bits are on the other port's data. A port that is LATE has a
// register behind its output, which takes the word of the clock before if OCE is 1.
module unitylink_ebr #(
  parameter A_WIDTH = 18, parameter B_WIDTH = 18, parameter A_MODE = 0, parameter B_MODE = 0,
  parameter A_LATE = 0, parameter B_LATE = 0,
  parameter [18431:0] FIRST = 0
) (
  input clock,
  input cea, input ocea, input wea, input [13:0] ada, input [17:0] dia, output [17:0] doa,
  input ceb, input oceb, input web, input [13:0] adb, input [17:0] dib, output [17:0] dob
);
  reg [8:0] memory [0:2047];
  reg [35:0] word_a = 0, word_b = 0, late_a = 0, late_b = 0;
  integer index;
  initial for (index = 0; index < 2048; index = index + 1) memory[index] = FIRST[9 * index +: 9];

  function [10:0] first(input integer width, input [13:0] address);
    first = width == 36 ? {address[13:5], 2'b00} : width == 18 ? {address[13:4], 1'b0} : address[13:3];
  endfunction
  function [35:0] part(input integer width, input [13:0] address, input [35:0] entries);
    case (width)
      4: part = address[2] ? entries[7:4] : entries[3:0];
      2: part = entries >> {address[2:1], 1'b0} & 3;
      1: part = entries >> address[2:0] & 1;
      default: part = entries;
    endcase
  endfunction
  function [8:0] merged(input integer width, input [13:0] address, input [8:0] entry, input [8:0] data);
    reg [8:0] ones;
    reg [2:0] low;
    begin
      ones = width == 4 ? 15 : width == 2 ? 3 : width == 1 ? 1 : 511;
      low = width == 4 ? {address[2], 2'b00} : width == 2 ? {address[2:1], 1'b0} : width == 1 ? address[2:0] : 0;
      merged = entry & ~(ones << low) | (data & ones) << low;
    end
  endfunction

  wire [10:0] at_a = first(A_WIDTH, ada), at_b = first(B_WIDTH, adb);
  wire [35:0] old_a = {memory[at_a + 3], memory[at_a + 2], memory[at_a + 1], memory[at_a]};
  wire [35:0] old_b = {memory[at_b + 3], memory[at_b + 2], memory[at_b + 1], memory[at_b]};
  wire [35:0] given_a = {dib, dia}, given_b = {18'b0, dib};
  wire [3:0] bytes_a = ~(cea & wea) ? 0 : A_WIDTH == 36 ? ada[3:0] : A_WIDTH == 18 ? {2'b00, ada[1:0]} : 4'b0001;
  wire [3:0] bytes_b = ~(ceb & web) ? 0 : B_WIDTH == 18 ? {2'b00, adb[1:0]} : 4'b0001;

  wire [35:0] given_word_a = A_LATE ? late_a : word_a, given_word_b = B_LATE ? late_b : word_b;
  assign doa = B_WIDTH == 36 ? given_word_b[17:0] : given_word_a[17:0];
  assign dob = B_WIDTH == 36 ? given_word_b[35:18] : given_word_b[17:0];

  always @(posedge clock) begin
    if (ocea) late_a <= word_a;
    if (oceb) late_b <= word_b;
    for (index = 0; index < 4; index = index + 1) begin
      if (bytes_a[index]) memory[at_a + index] <= merged(A_WIDTH, ada, old_a[9 * index +: 9], given_a[9 * index +: 9]);
      if (bytes_b[index]) memory[at_b + index] <= merged(B_WIDTH, adb, old_b[9 * index +: 9], given_b[9 * index +: 9]);
    end
    if (cea & (~wea | A_MODE == 2)) word_a <= part(A_WIDTH, ada, old_a);
    if (cea & wea & A_MODE == 1) word_a <= given_a;
    if (ceb & (~web | B_MODE == 2)) word_b <= part(B_WIDTH, adb, old_b);
    if (ceb & web & B_MODE == 1) word_b <= given_b;
  end
endmodule
