-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of receive_buffer: bytes and errors leave in the order of arrival.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity receive_buffer_formal is
  generic (
    depth : positive := 4
  );
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    line_valid : in std_ulogic;
    line_data  : in std_ulogic_vector(7 downto 0);
    line_error : in receive_error_t;
    rx_ready   : in std_ulogic;
    mark       : in std_ulogic -- follow this item
  );
end entity;

architecture properties of receive_buffer_formal is

  signal begun                        : std_ulogic := '0'; -- the reset of power-up is over
  signal line_ready, rx_valid         : std_ulogic;
  signal rx_data                      : std_ulogic_vector(7 downto 0);
  signal rx_error                     : receive_error_t;
  signal comes, told, offered, goes   : std_ulogic;
  signal came, item                   : std_ulogic_vector(10 downto 0); -- error above byte; an error has no byte

begin

  default clock is rising_edge(clk);

  dut : entity work.receive_buffer
    generic map (rx_depth => depth)
    port map (
      clock => clk, reset => reset,
      line_valid => line_valid, line_ready => line_ready, line_data => line_data, line_error => line_error,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error);

  comes   <= line_valid and line_ready;
  told    <= or rx_error;
  offered <= rx_valid or told;
  goes    <= (rx_valid and rx_ready) or told;
  came    <= line_error & line_data when line_error = no_receive_error else line_error & x"00";
  item    <= rx_error & rx_data when told = '0' else rx_error & x"00";

  items : entity work.order_view
    generic map (width => 11, most => depth + 1)
    port map (
      clk => clk, reset => reset, comes => comes, came => came, mark => mark,
      offered => offered, goes => goes, word => item);

  power_up : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A byte and an error are never given out in the same clock.
  never_both : assert always begun = '1' -> rx_valid = '0' or told = '0';

  -- A byte on offer stays the same until it is taken. No error is reported in that time.
  byte_stands : assert always begun = '1' and rx_valid = '1' and rx_ready = '0' and reset = '0' ->
                next (rx_valid = '1' and rx_data = prev(rx_data));

  -- An error is reported.
  error_seen : cover {begun = '1' and rx_valid = '0' and rx_error = "101"};

end architecture;
