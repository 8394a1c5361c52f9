function circle(port, seconds, height_mm)
% Leads haptolith's tool along a circle through its network device, and prints the force that a hand would feel.
%
%   haptolith run --device network        in a terminal
%   circle                                in MATLAB; circle(9050, 10, -90) is the default
%
% height_mm is the circle's height in the device's frame, whose origin is 85 mm above the soil. Octave needs first:
% pkg load instrument-control
if nargin < 1, port = 9050; end
if nargin < 2, seconds = 10; end
if nargin < 3, height_mm = -90; end
radius_m = 0.02;  turn_rad_s = pi / 2;
udp = udpport();                                          % any local port; answers come to it
sequence = 0;  answers = 0;  strongest_n = 0;  answered_s = 0;  printed_s = 0;  force_n = [0 0 0];
start = tic;
while toc(start) < seconds
  t_s = toc(start);
  c = cos(turn_rad_s * t_s);  s = sin(turn_rad_s * t_s);
  position_m = [radius_m * [c s], height_mm / 1000];
  velocity_m_s = [radius_m * turn_rad_s * [-s c], 0];
  packet = network_packet(sequence, t_s * 1e6, position_m, [1 0 0 0], velocity_m_s, [0 0 0], 0);
  write(udp, packet, "uint8", "127.0.0.1", port);
  sequence = sequence + 1;
  while udp.NumBytesAvailable >= 80                       % one answer after the other
    [good, told_n] = network_answer(uint8(read(udp, 80, "uint8")));
    if ~good, continue, end
    force_n = told_n;
    answered_s = t_s;
    answers = answers + 1;
    strongest_n = max(strongest_n, norm(force_n));
  end
  if t_s - answered_s > 0.02, force_n = [0 0 0]; end      % a device that pushes a hand must be sent zero force here
  if t_s - printed_s > 0.1
    printed_s = t_s;
    fprintf('force %7.3f %7.3f %7.3f N\n', force_n);
  end
  pause(0.001);
end
fprintf('%d packets sent, %d answers, strongest force %.3f N\n', sequence, answers, strongest_n);
clear udp
end
