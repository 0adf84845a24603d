-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_walk over a tosnet_table: rings of all sizes with random masks, which may be empty. Each byte has its address,
-- lane and owner in the order of a DATA packet, and is ready in time. A walk may be given up.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;

entity tosnet_walk_tb is
  generic (
    step_clocks : positive := 10; -- from one step to the next, three at least
    walks       : positive := 20;
    seed        : positive := 1
  );
end entity;

architecture test of tosnet_walk_tb is

  type bytes_t is array (0 to 15) of std_ulogic_vector(7 downto 0);

  signal clock       : std_ulogic := '0';
  signal done        : boolean := false;
  signal write_entry, write_mask : std_ulogic := '0';
  signal write_index : unsigned(3 downto 0) := "0000";
  signal write_data  : std_ulogic_vector(7 downto 0) := x"00";
  signal restart     : std_ulogic := '0';
  signal step        : std_ulogic := '0';
  signal nodes       : unsigned(3 downto 0) := "0001";
  signal own_address : unsigned(3 downto 0) := "0000";
  signal table_index : unsigned(3 downto 0);
  signal table_entry, table_mask : std_ulogic_vector(7 downto 0);
  signal ready, finished, own    : std_ulogic;
  signal address     : std_ulogic_vector(9 downto 0);
  signal lane        : unsigned(1 downto 0);

begin

  clock <= not clock after 10 ns when not done;

  network_registers : entity work.tosnet_table
    port map (
      clock => clock, write_entry => write_entry, write_mask => write_mask, write_index => write_index,
      write_data => write_data, read_index => table_index, entry => table_entry, mask => table_mask);

  dut : entity work.tosnet_walk
    port map (
      clock => clock, restart => restart, step => step, nodes => nodes, own_address => own_address,
      table_index => table_index, table_entry => table_entry, table_mask => table_mask, ready => ready,
      finished => finished, address => address, lane => lane, own => own);

  play : process is

    variable random         : random_t;
    variable entries, masks : bytes_t;
    variable left           : integer; -- bytes until the walk is given up

    procedure write (index : natural) is
    begin
      write_index <= to_unsigned(index, 4);
      write_data  <= entries(index);
      write_entry <= '1';
      tick(clock);
      write_entry <= '0';
      write_data  <= masks(index);
      write_mask  <= '1';
      tick(clock);
      write_mask  <= '0';
    end procedure;

    procedure check_byte (node : natural; number : natural; in_section : natural; place : natural) is
      constant where : natural := to_integer(unsigned(entries(node)(3 downto 0))) * 64 + number * 8
                                  + in_section * 4 + place / 4;
    begin
      check_equal(ready, '1', "ready in time");
      check_equal(finished, '0', "finished before the last byte");
      check_equal(to_integer(unsigned(address)), where, "the address of a byte");
      check_equal(to_integer(lane), place mod 4, "the lane of a byte");
      check_equal(own, to_bit(node = own_address), "whose section it is");
      step <= '1';
      tick(clock);
      step <= '0';
      tick(clock, step_clocks - 1);
    end procedure;

    procedure walk is
    begin
      for node in 0 to to_integer(nodes) - 1 loop
        for in_section in 0 to 1 loop
          for number in 7 downto 0 loop
            if masks(node)(number) = '1' then
              for place in 0 to 15 loop
                if left = 0 then
                  return;
                end if;
                left := left - 1;
                check_byte(node, number, in_section, place);
              end loop;
            end if;
          end loop;
        end loop;
      end loop;
      check_equal(ready, '0', "ready after the last byte");
      check_equal(finished, '1', "finished after the last byte");
    end procedure;

  begin
    random.seed(seed);
    for number in 0 to walks - 1 loop
      for node in 0 to 15 loop
        entries(node) := random.vector(8);
        masks(node)   := random.vector(8) and random.vector(8);
        if random.chance(30) then
          masks(node) := x"00";
        elsif random.chance(10) then
          masks(node) := x"FF";
        end if;
        if number = 15 then
          masks(node) := x"00";
        end if;
        write(node);
      end loop;
      nodes       <= to_unsigned(1 + number mod 15, 4);
      own_address <= to_unsigned(random.integer_between(0, number mod 15), 4);
      for turn in 1 to 2 loop
        left := -1;
        if turn = 1 and random.chance(50) then
          left := random.integer_between(0, 100); -- given up, so the next restart comes in the middle
        end if;
        restart <= '1';
        tick(clock);
        restart <= '0';
        tick(clock, 4 + 2 * to_integer(nodes));
        walk;
      end loop;
    end loop;
    report_passed("tosnet_walk_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 1 sec, "tosnet_walk_tb");

end architecture;
