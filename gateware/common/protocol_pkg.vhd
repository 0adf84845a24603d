-- SPDX-License-Identifier: BSD-3-Clause
-- The constants of the wire protocols. Generated from protocol/protocol.toml by protocol/generate.py; edit there.
library ieee;
use ieee.std_logic_1164.all;

package protocol_pkg is

  subtype byte_t is std_logic_vector(7 downto 0);

  -- protocol
  constant protocol_name_c : string := "unity-link";
  constant protocol_classic_version_c : natural := 1;

  -- bytes
  constant byte_plain_head_c : byte_t := x"23";
  constant byte_checked_head_c : byte_t := x"24";
  constant byte_plain_publish_c : byte_t := x"25";
  constant byte_checked_publish_c : byte_t := x"26";
  constant byte_error_mark_c : byte_t := x"3F";
  constant byte_data_mark_c : byte_t := x"3A";
  constant byte_checksum_mark_c : byte_t := x"2A";
  constant byte_line_feed_c : byte_t := x"0A";
  constant byte_carriage_return_c : byte_t := x"0D";
  constant byte_field_separator_c : byte_t := x"2C";

  -- crc8
  constant crc8_polynomial_c : byte_t := x"07";
  constant crc8_initial_c : byte_t := x"00";
  constant crc8_check_c : byte_t := x"F4";

  -- command
  constant command_read_c : string := "R";
  constant command_read_many_c : string := "RM";
  constant command_write_c : string := "W";
  constant command_read_configuration_c : string := "RLC";
  constant command_write_group_addresses_c : string := "WSA";
  constant command_write_group_rate_c : string := "WSR";
  constant command_read_group_c : string := "RSI";
  constant command_enable_publishing_c : string := "EPS";
  constant command_enable_checked_publishing_c : string := "EPC";
  constant command_disable_publishing_c : string := "DPS";
  constant command_write_event_mask_c : string := "WIC";
  constant command_read_event_mask_c : string := "RIC";

  -- reply
  constant reply_read_c : string := "S_R";
  constant reply_read_many_c : string := "S_RM";
  constant reply_write_c : string := "S_W";
  constant reply_read_configuration_c : string := "CNF";
  constant reply_write_group_addresses_c : string := "S_WSA";
  constant reply_write_group_rate_c : string := "S_WSR";
  constant reply_read_group_c : string := "S_RSI";
  constant reply_enable_publishing_c : string := "S_EPS";
  constant reply_enable_checked_publishing_c : string := "S_EPC";
  constant reply_disable_publishing_c : string := "S_DPS";
  constant reply_write_event_mask_c : string := "S_WIC";
  constant reply_read_event_mask_c : string := "S_RIC";
  constant reply_publish_c : string := "PUB";

  -- application_error
  constant application_error_incomplete_command_c : string := "E_ICC";
  constant application_error_missing_address_c : string := "E_MAB";
  constant application_error_missing_data_c : string := "E_MDB";
  constant application_error_invalid_block_size_c : string := "E_IBS";
  constant application_error_invalid_group_size_c : string := "E_ILA";
  constant application_error_invalid_group_c : string := "E_ISG";
  constant application_error_bus_error_read_c : string := "E_FBR";
  constant application_error_bus_error_write_c : string := "E_FBW";
  constant application_error_bus_timeout_c : string := "E_BAT";
  constant application_error_publish_vanished_c : string := "E_IPR";

  -- datalink_error
  constant datalink_error_message_too_long_c : byte_t := x"F0";
  constant datalink_error_format_c : byte_t := x"F1";
  constant datalink_error_odd_digits_c : byte_t := x"F2";
  constant datalink_error_invalid_character_c : byte_t := x"F3";
  constant datalink_error_checksum_c : byte_t := x"F4";
  constant datalink_error_physical_c : byte_t := x"F5";

  -- limits
  constant limits_address_bits_max_c : natural := 32;
  constant limits_data_bits_min_c : natural := 8;
  constant limits_data_bits_max_c : natural := 32;
  constant limits_read_many_max_c : natural := 255;
  constant limits_groups_max_c : natural := 256;
  constant limits_exchanges_max_c : natural := 256;
  constant limits_group_size_max_c : natural := 255;
  constant limits_rate_bytes_max_c : natural := 4;
  constant limits_groups_2012_c : natural := 16;
  constant limits_group_size_2012_c : natural := 32;
  constant limits_fifo_bytes_default_c : natural := 16;
  constant limits_event_mask_bytes_min_c : natural := 2;
  constant limits_bus_timeout_clocks_c : natural := 100;
  constant limits_clock_hz_default_c : natural := 50000000;
  constant limits_base_hz_default_c : natural := 1000;

  -- latency
  constant latency_tick_c : natural := 11;
  constant latency_read_c : natural := 9;
  constant latency_read_many_c : natural := 9;
  constant latency_read_many_word_c : natural := 3;
  constant latency_group_addresses_c : natural := 17;
  constant latency_group_address_c : natural := 3;
  constant latency_read_group_c : natural := 18;
  constant latency_read_group_address_c : natural := 2;
  constant latency_other_c : natural := 34;
  constant latency_publish_c : natural := 12;
  constant latency_publish_word_c : natural := 4;
  constant latency_publish_words_before_c : natural := 7;
  constant latency_turns_most_c : natural := 3;

  -- tosnet
  constant tosnet_address_bits_c : natural := 11;
  constant tosnet_memory_words_c : natural := 1024;
  constant tosnet_node_shift_c : natural := 6;
  constant tosnet_register_shift_c : natural := 3;
  constant tosnet_in_bit_c : natural := 2;
  constant tosnet_status_c : natural := 1024;
  constant tosnet_packet_counter_c : natural := 1025;
  constant tosnet_reset_counter_c : natural := 1026;
  constant tosnet_error_counter_c : natural := 1027;
  constant tosnet_network_registers_c : natural := 1280;
  constant tosnet_async_tx_status_c : natural := 1536;
  constant tosnet_async_tx_control_c : natural := 1537;
  constant tosnet_async_tx_data_c : natural := 1538;
  constant tosnet_async_rx_status_c : natural := 1792;
  constant tosnet_async_rx_data_c : natural := 1794;
  constant tosnet_status_online_bit_c : natural := 31;
  constant tosnet_status_master_bit_c : natural := 30;
  constant tosnet_status_packet_error_bit_c : natural := 29;
  constant tosnet_status_system_halt_bit_c : natural := 28;
  constant tosnet_status_network_sync_bit_c : natural := 27;
  constant tosnet_status_node_id_shift_c : natural := 20;
  constant tosnet_status_node_address_shift_c : natural := 16;
  constant tosnet_status_read_error_bit_c : natural := 8;
  constant tosnet_status_write_error_bit_c : natural := 7;
  constant tosnet_status_commit_aborted_bit_c : natural := 5;
  constant tosnet_status_read_pointer_bit_c : natural := 3;
  constant tosnet_status_write_pointer_bit_c : natural := 2;
  constant tosnet_status_read_frozen_bit_c : natural := 1;
  constant tosnet_status_commit_pending_bit_c : natural := 0;

  -- frame
  constant frame_version_c : natural := 1;
  constant frame_delimiter_c : natural := 0;
  constant frame_device_bit_c : natural := 64;
  constant frame_chained_bit_c : natural := 16;
  constant frame_barrier_bit_c : natural := 32;
  constant frame_operation_mask_c : natural := 15;
  constant frame_crc16_polynomial_c : natural := 33800;
  constant frame_crc16_check_c : natural := 28561;
  constant frame_crc16_bytes_c : natural := 3;
  constant frame_crc32_polynomial_c : std_logic_vector(31 downto 0) := x"82F63B78";
  constant frame_crc32_check_c : natural := 486108540;
  constant frame_crc32_bytes_c : natural := 5;
  constant frame_short_max_c : natural := 256;
  constant frame_short_payload_max_c : natural := 250;
  constant frame_open_epoch_c : natural := 65535;
  constant frame_checked_long_flag_c : natural := 1;
  constant frame_atomic_flag_c : natural := 1;
  constant frame_event_flag_c : natural := 1;
  constant frame_window_default_c : natural := 64;
  constant frame_cache_bytes_default_c : natural := 16;
  constant frame_posts_max_c : natural := 32767;

  -- rs485
  constant rs485_nodes_max_c : natural := 63;
  constant rs485_poll_bit_c : natural := 64;
  constant rs485_check_bit_c : natural := 128;
  constant rs485_check_polynomial_c : natural := 69;

  -- request_kind
  constant request_kind_hello_c : natural := 128;
  constant request_kind_open_c : natural := 129;
  constant request_kind_read_c : natural := 130;
  constant request_kind_write_c : natural := 131;
  constant request_kind_post_c : natural := 132;
  constant request_kind_list_c : natural := 133;
  constant request_kind_post_list_c : natural := 134;
  constant request_kind_exchange_c : natural := 135;
  constant request_kind_read_control_c : natural := 136;
  constant request_kind_write_control_c : natural := 137;
  constant request_kind_define_group_c : natural := 138;
  constant request_kind_define_exchange_c : natural := 139;
  constant request_kind_sync_c : natural := 140;
  constant request_kind_close_c : natural := 141;

  -- device_kind
  constant device_kind_reply_c : natural := 192;
  constant device_kind_hello_c : natural := 208;
  constant device_kind_open_c : natural := 209;
  constant device_kind_publish_c : natural := 210;
  constant device_kind_closed_c : natural := 211;

  -- list_operation
  constant list_operation_read_c : natural := 1;
  constant list_operation_read_up_c : natural := 2;
  constant list_operation_read_fifo_c : natural := 3;
  constant list_operation_write_c : natural := 17;
  constant list_operation_write_up_c : natural := 18;
  constant list_operation_write_fifo_c : natural := 19;
  constant list_operation_write_masked_c : natural := 20;
  constant list_operation_add_c : natural := 21;

  -- reply_status
  constant reply_status_ok_c : natural := 0;
  constant reply_status_bus_error_c : natural := 1;
  constant reply_status_bus_timeout_c : natural := 2;
  constant reply_status_bad_address_c : natural := 3;
  constant reply_status_denied_c : natural := 4;
  constant reply_status_busy_c : natural := 5;
  constant reply_status_invalid_c : natural := 6;
  constant reply_status_too_long_c : natural := 7;
  constant reply_status_order_c : natural := 8;
  constant reply_status_behind_c : natural := 9;
  constant reply_status_no_group_c : natural := 10;

  -- control
  constant control_magic_c : natural := 0;
  constant control_version_c : natural := 1;
  constant control_gateware_version_c : natural := 2;
  constant control_build_c : natural := 3;
  constant control_widths_c : natural := 4;
  constant control_clock_hz_c : natural := 5;
  constant control_base_hz_c : natural := 6;
  constant control_features_c : natural := 7;
  constant control_request_credit_c : natural := 8;
  constant control_frame_limits_c : natural := 9;
  constant control_window_c : natural := 10;
  constant control_groups_c : natural := 11;
  constant control_exchanges_c : natural := 12;
  constant control_spec_hash_high_c : natural := 13;
  constant control_spec_hash_low_c : natural := 14;
  constant control_frames_c : natural := 32;
  constant control_discarded_check_c : natural := 33;
  constant control_discarded_kind_c : natural := 34;
  constant control_discarded_session_c : natural := 35;
  constant control_discarded_stale_c : natural := 36;
  constant control_discarded_long_c : natural := 37;
  constant control_duplicates_c : natural := 38;
  constant control_posts_c : natural := 39;
  constant control_posts_ahead_c : natural := 40;
  constant control_posts_old_c : natural := 41;
  constant control_post_errors_c : natural := 42;
  constant control_bus_errors_c : natural := 43;
  constant control_bus_timeouts_c : natural := 44;
  constant control_publishes_c : natural := 45;
  constant control_publish_overruns_c : natural := 46;
  constant control_receive_overruns_c : natural := 47;
  constant control_refused_c : natural := 48;
  constant control_deadman_trips_c : natural := 49;
  constant control_time_low_c : natural := 64;
  constant control_time_high_c : natural := 65;
  constant control_deadman_ticks_c : natural := 66;
  constant control_arm_c : natural := 67;
  constant control_publish_c : natural := 68;

  -- control_value
  constant control_value_magic_c : natural := 1431062098;
  constant control_value_feature_classic_c : natural := 1;
  constant control_value_feature_publishing_c : natural := 2;
  constant control_value_feature_lists_c : natural := 4;
  constant control_value_feature_exchanges_c : natural := 8;
  constant control_value_feature_deadman_c : natural := 16;
  constant control_value_feature_long_frames_c : natural := 32;

end package protocol_pkg;
