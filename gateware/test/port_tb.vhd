-- SPDX-License-Identifier: BSD-3-Clause
--
-- port_splitter and port_joiner: random bytes and messages, both sides at random, compared with a short model.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;

entity port_tb is
  generic (
    seed  : positive := 1;
    bytes : positive := 4000
  );
end entity;

architecture bench of port_tb is

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal split_ended, join_ended : boolean := false;

  signal rx_valid, rx_ready, classic_valid, classic_ready, frame_valid, frame_ready : std_ulogic := '0';
  signal rx_data : std_ulogic_vector(7 downto 0) := x"00";

  signal text_valid, text_ready, text_last, text_publish : std_ulogic := '0';
  signal data_valid, data_ready, data_last, data_publish : std_ulogic := '0';
  signal text_data, data_data, tx_data : std_ulogic_vector(7 downto 0) := x"00";
  signal tx_valid, tx_ready, tx_last, tx_publish : std_ulogic := '0';

begin

  clock <= not clock after 5 ns when not (split_ended and join_ended);

  splitter : entity work.port_splitter
    port map (
      clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      classic_valid => classic_valid, classic_ready => classic_ready,
      frame_valid => frame_valid, frame_ready => frame_ready);

  joiner : entity work.port_joiner
    port map (
      clock => clock, reset => reset,
      classic_valid => text_valid, classic_ready => text_ready, classic_data => text_data, classic_last => text_last,
      classic_publish => text_publish,
      frame_valid => data_valid, frame_ready => data_ready, frame_data => data_data, frame_last => data_last,
      frame_publish => data_publish,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  split : process
    variable random       : random_t;
    variable after_border : boolean := false;
    variable framed       : boolean := false;
    variable frames, texts, waits : natural := 0;
    variable value        : natural;
  begin
    random.seed(seed);
    wait until rising_edge(clock);
    wait until rising_edge(clock);
    reset <= '0';
    for number in 1 to bytes loop
      case random.integer_between(0, 3) is
        when 0      => value := 0;
        when 1      => value := character'pos('#');
        when others => value := random.integer_between(0, 255);
      end case;
      rx_data  <= std_ulogic_vector(to_unsigned(value, 8));
      rx_valid <= '1';
      if not framed then
        framed := after_border and value >= 128;
      end if;
      loop
        classic_ready <= '1' when random.chance(60) else '0';
        frame_ready   <= '1' when random.chance(60) else '0';
        wait for 1 ns;
        check((frame_valid = '1') = framed, "it is of a frame");
        check((classic_valid = '1') = (not framed), "it is classic");
        check(rx_ready = ((frame_ready and frame_valid) or (classic_ready and classic_valid)), "it is taken");
        waits := waits + 1;
        wait until rising_edge(clock);
        exit when rx_ready = '1';
      end loop;
      if framed then
        frames := frames + 1;
      else
        texts := texts + 1;
      end if;
      after_border := value = 0;
      framed       := framed and value /= 0;
    end loop;
    rx_valid <= '0';
    check(frames > bytes / 10 and texts > bytes / 10 and waits > bytes, "both sides, and waiting");
    split_ended <= true;
    wait;
  end process;

  -- Two senders of messages. Bit 7 marks the last byte, bit 6 marks classic bytes, and the lower bits count.
  texts : process
    variable random : random_t;
  begin
    random.seed(seed + 1);
    wait until reset = '0';
    while not join_ended loop
      for index in 0 to random.integer_between(0, 5) loop
        while random.chance(40) loop
          wait until rising_edge(clock) or join_ended;
          exit when join_ended;
        end loop;
        text_last    <= '1' when random.chance(30) else '0';
        text_publish <= '1' when random.chance(50) else '0';
        wait for 1 ns;
        text_data  <= text_last & '1' & text_publish & std_ulogic_vector(to_unsigned(index, 5));
        text_valid <= '1';
        wait until (rising_edge(clock) and text_ready = '1') or join_ended;
        text_valid <= '0';
      end loop;
    end loop;
    wait;
  end process;

  frames : process
    variable random : random_t;
  begin
    random.seed(seed + 2);
    wait until reset = '0';
    while not join_ended loop
      while random.chance(70) loop
        wait until rising_edge(clock) or join_ended;
        exit when join_ended;
      end loop;
      data_last    <= '1' when random.chance(30) else '0';
      data_publish <= '1' when random.chance(50) else '0';
      wait for 1 ns;
      data_data  <= data_last & '0' & data_publish & "00000";
      data_valid <= '1';
      wait until (rising_edge(clock) and data_ready = '1') or join_ended;
      data_valid <= '0';
    end loop;
    wait;
  end process;

  join : process
    variable random : random_t;
    variable inside : boolean := false;
    variable side   : std_ulogic := '0';
    variable taken, messages, chosen : natural := 0;
  begin
    random.seed(seed + 3);
    wait until reset = '0';
    while taken < bytes loop
      tx_ready <= '1' when random.chance(70) else '0';
      wait until rising_edge(clock);
      if tx_valid = '1' then
        if not inside then
          side := tx_data(6);
          if data_valid = '1' then
            check_equal(side, '0', "a frame goes first");
          end if;
          chosen := chosen + 1;
        end if;
        check_equal(tx_data(6), side, "the side within a message");
        check_equal(tx_last, tx_data(7), "last");
        check_equal(tx_publish, tx_data(5), "publish");
        inside := true;
        if tx_ready = '1' then
          taken := taken + 1;
          if tx_last = '1' then
            inside   := false;
            messages := messages + 1;
          end if;
        end if;
      end if;
    end loop;
    check(messages > 100, "messages");
    if not split_ended then
      wait until split_ended;
    end if;
    report_passed("port_tb");
    join_ended <= true;
    wait;
  end process;

  watchdog(join_ended, bytes * 1 us, "port_tb");

end architecture;
