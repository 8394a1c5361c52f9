function bytes = network_packet(sequence, time_us, position_m, orientation_wxyz, velocity_m_s, angular_velocity_rad_s, gripper_open) %#codegen
% Builds the 136-byte packet that holds haptolith's tool; row vectors in the sender's right-handed frame (docs/reference/udp.md).
bytes = [uint8('HLDV'), ...
  typecast(uint16([1 1]), 'uint8'), ...                       % version; flags: the dead-man switch is held
  typecast(uint32([mod(sequence, 2^32) 0]), 'uint8'), ...     % one more with each packet; buttons
  typecast(uint64(time_us), 'uint8'), ...                     % returned in the answer
  typecast([position_m, orientation_wxyz, velocity_m_s, angular_velocity_rad_s, gripper_open], 'uint8')];
end
