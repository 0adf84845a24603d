-- SPDX-License-Identifier: BSD-3-Clause
--
-- Attributes of flip-flops that take a signal from another clock or from a pin: each tool reads its own, and passes
-- over the others. They keep the flip-flops of a synchroniser apart from all else, and next to each other.
--
-- Only three kinds of registers take what is not synchronous to their clock. Constraints find them by these names, so
-- an instance and a signal must be called so (tests/gateware/test_crossings.py holds that, for every design):
--   first        of an instance called ..synchroniser    single bits
--   .._crossed                                           data that stand still while they are taken
--   reset_over   of reset_synchroniser                   cleared from outside

package crossing_pkg is

  -- Vivado: place them next to each other, count them as a synchroniser, make no shift register of them.
  attribute async_reg     : string;
  attribute shreg_extract : string;

  -- Quartus: neither merge nor copy them; count them as a synchroniser where the clocks differ.
  attribute preserve         : boolean;
  attribute altera_attribute : string;
  constant altera_crossing_c : string := "-name SYNCHRONIZER_IDENTIFICATION FORCED_IF_ASYNCHRONOUS";

  -- Synplify and LSE (Diamond, Radiant, Libero): the same.
  attribute syn_preserve : boolean;
  attribute syn_srlstyle : string;

end package;
