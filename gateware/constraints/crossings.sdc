# SPDX-License-Identifier: BSD-3-Clause
#
# Clock crossings of Unity-Link's gateware, for Quartus: add this file to the project behind the one with the clocks.
#
# Quartus counts the skew of two clocks as part of a path between them. So the path is set free, and the nets and their
# skew are bounded, as Intel does for its own FIFOs between clocks. That frees each path between two clocks, also in
# logic of your own: see that it crosses as this gateware does. What comes from another clock has one period of the
# fastest clock: then the bits of a Grey count arrive within one clock of each other.

set unitylink_period 1000000
foreach_in_collection clock [all_clocks] {
  set period [get_clock_info -period $clock]
  if {$period < $unitylink_period} { set unitylink_period $period }
}

foreach_in_collection clock [all_clocks] {
  foreach_in_collection other [all_clocks] {
    if {[get_clock_info -name $clock] ne [get_clock_info -name $other]} {
      set_max_delay -from $clock -to $other 100
      set_min_delay -from $clock -to $other -100
    }
  }
}

foreach pattern {*synchroniser*|first[*] *_crossed[*]} {
  set registers [get_registers -nowarn $pattern]
  if {[get_collection_size $registers] > 0} {
    set_net_delay -from [get_registers *] -to $registers -max $unitylink_period
    set_max_skew -from [get_registers *] -to $registers $unitylink_period
  }
}

foreach pattern {*|reset_over[*]|clrn *spi_slave*|place[*]|clrn} {
  set clears [get_pins -nowarn -compatibility_mode $pattern]
  if {[get_collection_size $clears] > 0} { set_false_path -to $clears }
}
