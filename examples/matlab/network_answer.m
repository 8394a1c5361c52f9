function [good, force_n, torque_nm, time_us, live] = network_answer(bytes) %#codegen
% Parses the 80 bytes of an answer; forces are on the hand, in the sender's frame. good is false for any other packet.
force_n = [0 0 0];  torque_nm = [0 0 0];  time_us = 0;  live = false;
good = numel(bytes) == 80 && isequal(char(bytes(1:4)), 'HLAN') && typecast(bytes(5:6), 'uint16') == 1;
if good
  live = bitand(typecast(bytes(7:8), 'uint16'), uint16(1)) ~= 0;   % the sender is trusted
  time_us = double(typecast(bytes(17:24), 'uint64'));              % the sender's, in the packet that is answered
  force_n = typecast(bytes(25:48), 'double');
  torque_nm = typecast(bytes(49:72), 'double');
end
end
