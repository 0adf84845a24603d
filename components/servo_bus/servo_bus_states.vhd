-- SPDX-License-Identifier: BSD-3-Clause
--
-- What servo_bus knows of each servo: whether its values are valid, whether it gets its torque, and its failures.
-- `servo` is the one whose turn it is.
--
--   copies    a cycle begins: from its drive follow whether it is told its torque, engaged, and holding
--   gives_up  its question had no good reply; `any` says that there was a wrong one
--   commits   its reply was good: the banks of its values change places
--   stops     nobody is valid, engaged or holding any more
--
-- `failures` and `reason` are those of the servo `reported`.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.servo_bus_pkg.all;

entity servo_bus_states is
  generic (
    servos        : positive range 1 to 8;
    failures_most : positive range 1 to 7
  );
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic; -- synchronous
    stops    : in  std_ulogic;
    servo    : in  servo_t;
    drive    : in  std_ulogic_vector(1 downto 0);
    copies   : in  std_ulogic;
    gives_up : in  std_ulogic;
    any      : in  std_ulogic;
    commits  : in  std_ulogic;

    told     : out std_ulogic_vector(servos - 1 downto 0) := (others => '0');
    engaged  : out std_ulogic_vector(servos - 1 downto 0) := (others => '0');
    holding  : out std_ulogic_vector(servos - 1 downto 0) := (others => '0');
    valid    : out std_ulogic_vector(servos - 1 downto 0) := (others => '0');
    bank     : out std_ulogic_vector(servos - 1 downto 0) := (others => '0'); -- that is read

    reported : in  servo_t;
    failures : out unsigned(7 downto 0);
    reason   : out std_ulogic_vector(1 downto 0)
  );
end entity;

architecture rtl of servo_bus_states is

  type failures_t is array (0 to servos - 1) of unsigned(7 downto 0);
  type reasons_t is array (0 to servos - 1) of std_ulogic_vector(1 downto 0);

  signal failed  : failures_t := (others => (others => '0'));
  signal reasons : reasons_t := (others => "00");

begin

  failures <= failed(minimum(to_integer(reported), servos - 1));
  reason   <= reasons(minimum(to_integer(reported), servos - 1));

  each : for number in 0 to servos - 1 generate
    signal mine     : std_ulogic; -- it is the turn of this servo
    signal known    : std_ulogic; -- it has given a position
    signal in_a_row : unsigned(2 downto 0) := (others => '0');
  begin
    mine  <= servo ?= number;
    known <= valid(number) or engaged(number);

    process (clock) is
    begin
      if rising_edge(clock) then
        if mine = '1' and copies = '1' then
          told(number)    <= nor drive or known;
          engaged(number) <= or drive and known;
          holding(number) <= not drive(1) and drive(0) and (valid(number) or holding(number));
        end if;

        if mine = '1' and gives_up = '1' then
          failed(number)  <= failed(number) + 1;
          reasons(number) <= any & not any;
          if in_a_row = failures_most - 1 then
            valid(number) <= '0';
          else
            in_a_row <= in_a_row + 1;
          end if;
        end if;

        if mine = '1' and commits = '1' then
          bank(number)    <= not bank(number);
          valid(number)   <= '1';
          reasons(number) <= "00";
          in_a_row        <= (others => '0');
        end if;

        if reset = '1' or stops = '1' then
          valid(number)   <= '0';
          engaged(number) <= '0';
          holding(number) <= '0';
        end if;
      end if;
    end process;
  end generate;

end architecture;
