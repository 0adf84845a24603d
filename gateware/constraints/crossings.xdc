# SPDX-License-Identifier: BSD-3-Clause
#
# Clock crossings of Unity-Link's gateware, for Vivado: read_xdc -unmanaged crossings.xdc, when all clocks are made.
#
# What comes from another clock has one period of the fastest clock: then the bits of a Grey count arrive within one
# clock of each other. Paths within a clock are left as they are. What clears a reset has no path at all.

set unitylink_period [lindex [lsort -real [get_property PERIOD [all_clocks]]] 0]

foreach unitylink_clock [all_clocks] {
  set unitylink_others {}
  foreach unitylink_other [all_clocks] {
    if {$unitylink_other ne $unitylink_clock} { lappend unitylink_others $unitylink_other }
  }
  set unitylink_cells [filter -quiet [all_registers -cells -clock [get_clocks $unitylink_clock]] \
    {NAME =~ *synchroniser/first_reg* || NAME =~ *_crossed_reg*}]
  if {[llength $unitylink_cells] && [llength $unitylink_others]} {
    set_max_delay -datapath_only -from [get_clocks $unitylink_others] -to $unitylink_cells $unitylink_period
  }
}

set unitylink_clears [get_pins -quiet -hierarchical \
  -filter {NAME =~ *reset_over_reg*/CLR || NAME =~ *spi_slave*place_reg*/CLR}]
if {[llength $unitylink_clears]} { set_false_path -to $unitylink_clears }
