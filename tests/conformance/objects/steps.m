% SPDX-License-Identifier: BSD-3-Clause
% The steps in Octave. steps.py and the others do the same and print the same lines.
1;

function say(name, varargin)
  persistent step
  if isempty(step)
    step = 0;
  end
  step = step + 1;
  printf('%02d %s: %s\n', step, name, sprintf(varargin{:}));
end

function refused(name, call)
  try
    call();
    say(name, 'done');
  catch failure
    if strcmp(failure.identifier, 'unitylink:Range')
      say(name, 'refused');
    elseif strcmp(failure.identifier, 'unitylink:ProtocolError')
      say(name, 'unexpected');
    else
      rethrow(failure);
    end
  end
end

function text = decimal(number)
  % sprintf of Octave makes a double of it, which has no 64 bits.
  text = strtrim(evalc('disp(number)'));
end

function put(part, name, value)
  part.(name) = value;
end

function whole(robot)
  robot.count = 123456;
  say('count', '%d', robot.count);
  robot.count = 4294967295;
  say('count', '%d', robot.count);
  robot.small = -100;
  say('small', '%d', robot.small);
  refused('small 101', @() put(robot, 'small', 101));
  refused('small -101', @() put(robot, 'small', -101));
  say('small', '%d', robot.small);
  robot.big = intmax('uint64');
  say('big', '%s', decimal(robot.big));
  robot.big = 0x0123456789ABCDEFu64;
  say('big', '%s', decimal(robot.big));
end

function real_numbers(robot)
  robot.gain = 2.5;
  say('gain', '%.6f', robot.gain);
  refused('gain 10.5', @() put(robot, 'gain', 10.5));
  refused('gain NaN', @() put(robot, 'gain', NaN));
  robot.exact = -0.1;
  say('exact', '%.17g', robot.exact);
  refused('exact infinite', @() put(robot, 'exact', Inf));
  robot.j(1).torque = 1.503;
  say('torque', '%.8f', robot.j(1).torque);
  robot.j(2).torque = 99;
  say('torque', '%.8f', robot.j(2).torque);
  robot.j(2).torque = -99;
  say('torque', '%.8f', robot.j(2).torque);
  robot.j(1).target = -1.2345;
  refused('target 3.5', @() put(robot.j(1), 'target', 3.5));
  say('pos', '%.3f %.3f', robot.j(1).pos, robot.j(2).pos);
end

function named(robot)
  robot.j(1).mode = steps.Mode.stop;
  say('mode', '%d', robot.j(1).mode);
  refused('mode 2', @() put(robot.j(1), 'mode', 2));
  refused('mode of the board', @() robot.j(2).mode);
  robot.level = steps.Level.high;
  say('level', '%d', robot.level);
  robot.level = 200;
  say('level', '%d', robot.level);
  robot.status = struct('ready', true, 'mode', steps.Mode.run, 'heat', -12.5);
  status = robot.status;
  say('status', '%d %d %.1f', status.ready, status.mode, status.heat);
  status.heat = 64;
  refused('status hot', @() put(robot, 'status', status));
  robot.lamps = [true false true];
  say('lamps', '%d %d %d', robot.lamps);
end

function special(robot)
  say('faults', '%d', robot.faults);
  robot.clear_faults(4);
  say('faults', '%d', robot.faults);
  say('lost', '%d', robot.take_lost());
  robot.pulse_reset(3);
  say('reset', 'pulsed');
  refused('reset 16', @() robot.pulse_reset(16));
  robot.net.a = -7;
  say('net', '%d %.1f', robot.net.a, robot.net.b);
  robot.net.b = 12.3;
  say('net', '%d %.1f', robot.net.a, robot.net.b);
  robot.net.a = 8;
  say('net', '%d %.1f', robot.net.a, robot.net.b);
end

function together(robot)
  robot.targets = [0.25 -0.25];
  say('limit', '%d', robot.limit);
  robot.j(2).mode = steps.Mode.idle;
  cycle = robot.j(1).cycle();
  state = cycle.exchange(struct('target', 1.5, 'mode', steps.Mode.run, 'torque', -2.25));
  say('cycle', '%.3f %d %.3f', state.pos, state.mode, state.torque);
  refused('cycle 4', @() cycle.exchange(struct('target', 4, 'mode', 0, 'torque', 0)));
  state = cycle.exchange(struct('target', -1.5, 'mode', steps.Mode.stop, 'torque', 50));
  say('cycle', '%.3f %d %.3f', state.pos, state.mode, state.torque);
  cycle.close();
  shot = robot.snapshot();
  say('snapshot', '%d %d %s %.3f %.3f', shot.count, shot.small, decimal(shot.big), shot.gain, shot.j(2).torque);
  robot.published_pose.start();
  robot.published_pose.wait(10);
  rows = robot.published_pose.poll(1);
  say('published', '%.3f', rows.j_1_pos);
  robot.published_pose.stop();
end

given = argv();
robot = steps.Steps(given{1});
whole(robot);
real_numbers(robot);
named(robot);
special(robot);
together(robot);
robot.close();
