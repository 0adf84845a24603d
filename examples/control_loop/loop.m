% SPDX-License-Identifier: BSD-3-Clause
% Holds the joint at an angle, 200 times a second:  octave-cli --path matlab loop.m LINK ANGLE SECONDS
given = argv();  % in MATLAB: given = {'tcp://127.0.0.1:5555', '0.5', '2'};
wanted = str2double(given{2});
cycles = round(200 * str2double(given{3}));
robot = joint.Joint(given{1});  % checks that the board has this spec
robot.set_dead_man(1);
cycle = robot.cycle();
out = robot.initial();
begun = tic();
for number = 1:cycles
  in = cycle.exchange(out);  % one message each way
  out.torque = max(-2, min(2, 8 * (wanted - in.angle) - 0.6 * in.speed));
  pause(max(0, number / 200 - toc(begun)));
end
robot.torque = 0;
cycle.close();
robot.close();
fprintf('%d cycles, the angle is %.3f rad\n', cycles, in.angle);
