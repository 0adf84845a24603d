-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of spi_slave. Its clock and sck have any timing, but the clock is at least as fast. The master selects,
-- and breaks off, after any falling edge of sck. The order is checked by following any one byte each way by its number.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;

entity spi_slave_formal is
  generic (
    depth : positive := 2
  );
  port (
    clk        : in std_ulogic;
    sck        : in std_ulogic;
    unselect   : in std_ulogic; -- the master ends the selection after this falling edge of sck
    colour_in  : in std_ulogic; -- all bits of the byte that the PC begins to send
    rx_ready   : in std_ulogic;
    tx_valid   : in std_ulogic;
    tx_last    : in std_ulogic;
    colour_out : in std_ulogic; -- all bits but one of the byte to the PC
    mark_in    : in std_ulogic; -- follow the byte that comes now
    mark_out   : in std_ulogic
  );
end entity;

architecture properties of spi_slave_formal is

  subtype byte_t is std_ulogic_vector(7 downto 0);
  subtype number_t is unsigned(2 downto 0); -- of a byte modulo 8; at most 5 are on their way

  constant places : natural := depth + 2; -- bytes from the PC that may wait

  -- The master.
  signal cs_n            : std_ulogic := '1';
  signal place           : unsigned(2 downto 0) := "000";
  signal mosi            : std_ulogic;
  signal sends, hears    : byte_t := (others => '0');
  signal given, got      : number_t := (others => '0');
  signal follow_in       : number_t := (others => '0');
  signal in_marked       : std_ulogic := '0';
  signal out_done, wrong : std_ulogic := '0';
  signal in_byte         : byte_t;

  -- The FPGA.
  signal miso, miso_drive, waiting    : std_ulogic;
  signal rx_valid, tx_ready           : std_ulogic;
  signal rx_data, tx_data             : byte_t;
  signal rx_error                     : receive_error_t;
  signal received, said               : number_t := (others => '0');
  signal in_done                      : std_ulogic := '0';
  signal follow_out                   : number_t := (others => '0');
  signal out_marked                   : std_ulogic := '0';
  signal out_byte                     : byte_t;

  signal ticks, ticks_before          : unsigned(1 downto 0) := "00"; -- of clk, and at the last rising edge of sck
  signal ticked                       : std_ulogic := '0';

begin

  default clock is rising_edge(clk);

  mosi    <= colour_in when place = 0 else sends(0);
  tx_data <= (7 downto 1 => colour_out) & '1'; -- not the filler byte

  dut : entity work.spi_slave
    generic map (rx_depth => depth, tx_depth => depth)
    port map (
      clock => clk, reset => '0',
      sck => sck, cs_n => cs_n, mosi => mosi, miso => miso, miso_drive => miso_drive, waiting => waiting,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last);

  master_samples : process (sck) is
  begin
    if rising_edge(sck) then
      ticks_before <= ticks;
      ticked       <= '1';
      if cs_n = '0' then
        hears <= hears(6 downto 0) & miso;
        sends <= sends(6 downto 0) & mosi;
      end if;
      if cs_n = '0' and place = 7 then
        given <= given + 1;
        if mark_in = '1' and in_marked = '0' then
          in_marked <= '1';
          follow_in <= given;
          in_byte   <= sends(6 downto 0) & mosi;
        end if;
      end if;
    end if;
  end process;

  master_changes : process (sck) is
  begin
    if falling_edge(sck) then
      cs_n <= unselect;
      if cs_n = '0' then
        place <= place + 1;
        if place = 7 then
          if hears /= x"00" then
            got <= got + 1;
            if out_marked = '1' and out_done = '0' and got = follow_out then
              out_done <= '1';
              wrong    <= or (hears xor out_byte);
            end if;
          end if;
        end if;
      end if;
      if unselect = '1' then
        place <= "000";
      end if;
    end if;
  end process;

  streams : process (clk) is
  begin
    if rising_edge(clk) then
      ticks <= ticks + 1;
      if rx_valid = '1' and rx_ready = '1' then
        received <= received + 1;
        if in_marked = '1' and received = follow_in then
          in_done <= '1';
        end if;
      end if;
      if tx_valid = '1' and tx_ready = '1' then
        said <= said + 1;
        if mark_out = '1' and out_marked = '0' then
          out_marked <= '1';
          follow_out <= said;
          out_byte   <= tx_data;
        end if;
      end if;
    end if;
  end process;

  -- The clock is at least as fast as sck: it rises between any two rising edges of sck.
  clock_is_fast : assume (always ticked = '0' or ticks /= ticks_before) @rising_edge(sck);

  -- The PC keeps to its credit: it sends only bytes for which there is room.
  credit_is_kept : assume (always cs_n = '1' or place /= 7 or given - received < places) @rising_edge(sck);

  -- miso is driven exactly while the slave is selected.
  driven_if_selected : assert always miso_drive = not cs_n;

  -- No byte from the PC is lost for lack of room.
  no_overrun : assert always rx_error = no_receive_error;

  -- A byte is offered only if one came.
  none_of_nothing : assert always rx_valid = '1' -> given /= received;

  -- No byte from the PC is lost, doubled or changed: the byte on offer is the next whole byte that came.
  read_in_order : assert always rx_valid = '1' and in_marked = '1' and in_done = '0' and
                  received = follow_in -> rx_data = in_byte;

  -- The PC gets only bytes that were sent, apart from filler. At most depth + 3 bytes are on their way.
  heard_was_said : assert always said - got <= depth + 3;

  -- No byte to the PC is lost, doubled or changed, even if a transfer breaks off. The last whole byte that the PC got
  -- is the next one sent.
  heard_in_order : assert always wrong = '0';

  -- A byte from the PC reaches the core.
  received_one : cover {received = 1};
  -- A byte reaches the PC.
  heard_one : cover {got = 1};

end architecture;
