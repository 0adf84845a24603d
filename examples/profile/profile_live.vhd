-- SPDX-License-Identifier: BSD-3-Clause
--
-- The generated profile_design and the logic of one's own, on byte streams: for RtlBoard, or any physical layer. On a
-- board with a UART profile_top takes the place of profile_design; its other ports are these.
--
-- Ports, latency, errors, pressure: those of profile_design.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.physical_pkg.all;
use work.profile_user_pkg.all;

entity profile_live is
  generic (
    clock_hz : positive := 12_000_000
  );
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic;
    rx_valid : in  std_ulogic;
    rx_ready : out std_ulogic;
    rx_data  : in  std_ulogic_vector(7 downto 0);
    rx_error : in  receive_error_t;
    tx_valid : out std_ulogic;
    tx_ready : in  std_ulogic;
    tx_data  : out std_ulogic_vector(7 downto 0)
  );
end entity;

architecture rtl of profile_live is

  signal read_words    : std_ulogic_vector(31 downto 0);
  signal write_words   : std_ulogic_vector(31 downto 0);
  signal to_pc         : profile_to_pc_t;
  signal from_pc       : profile_from_pc_t;
  signal table_address : natural range 0 to 31;
  signal table_data    : std_ulogic_vector(31 downto 0);
  signal sample_valid  : std_ulogic;
  signal sample_ready  : std_ulogic;
  signal sample_data   : std_ulogic_vector(31 downto 0);

begin

  read_words <= to_words(to_pc);
  from_pc    <= from_words(write_words);

  bridge : entity work.profile_design
    generic map (clock_hz => clock_hz)
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data,
      read_words => read_words, write_words => write_words,
      table_user_read_address => table_address, table_user_read_data => table_data,
      samples_to_pc_valid => sample_valid, samples_to_pc_ready => sample_ready, samples_to_pc_data => sample_data);

  player : entity work.profile_player
    generic map (clock_hz => clock_hz)
    port map (
      clock => clock, reset => reset, play => from_pc.play, playing => to_pc.playing,
      table_address => table_address, table_data => table_data,
      sample_valid => sample_valid, sample_ready => sample_ready, sample_data => sample_data);

end architecture;
