% SPDX-License-Identifier: BSD-3-Clause
% What the objects say when something fails, and what the steps leave out: probe(URL of steps, URL of typed).
1;

function told(name, call)
  try
    call();
    printf('%s: done\n', name);
  catch failure
    printf('%s: %s %s\n', name, failure.identifier, failure.message);
  end
end

function put(part, name, value)
  part.(name) = value;
end

given = argv();
told('no port', @() steps.Steps('tcp://127.0.0.1:1'));
told('no url', @() steps.Steps('nonsense'));
told('too many urls', @() steps.Steps('a', 'b', 'c'));
robot = steps.Steps(given{1});
told('verified', @() assert(isempty(robot.unverified())));
told('range', @() put(robot, 'small', 101));
told('below zero', @() put(robot, 'count', -1));
told('no whole number', @() put(robot, 'count', 2.5));
told('beyond 64 bits', @() put(robot, 'big', 2 ^ 64));
told('not a number', @() put(robot.j(2), 'target', NaN));
told('not a member', @() put(robot.j(1), 'mode', 2));
told('strange member', @() robot.j(2).mode);
told('no flag', @() put(robot, 'lamps', [0 1 2]));
told('two lamps', @() put(robot, 'lamps', [0 1]));
told('a text', @() put(robot, 'count', 'x'));
told('no struct', @() put(robot, 'status', 3));
told('no field', @() put(robot, 'status', struct('ready', true, 'mode', 1)));
told('packed', @() put(robot, 'status', struct('ready', true, 'mode', 2, 'heat', 0)));
told('read only', @() put(robot, 'limit', 1));
told('write only', @() robot.j(1).target);
told('group', @() robot.targets);
told('group of three', @() put(robot, 'targets', [1 2 3]));
told('group without one', @() put(robot, 'targets', struct('j_0_target', 1)));
told('other field', @() put(robot, 'targets', struct('j_0_target', 1, 'j_1_target', 1, 'more', 1)));
told('no part', @() put(robot, 'net', 3));
told('not started', @() robot.published_pose.poll());
told('empty queue', @() robot.queue.take_sample());
told('no property', @() put(robot, 'nothing', 3));
told('no place', @() unitylink_mex('read', robot.ul_session.number, 1000));
told('no call', @() unitylink_mex('nothing', robot.ul_session.number));
told('no arguments', @() unitylink_mex('read'));

clear mex unitylink_mex
printf('locked: %d\n', mislocked('unitylink_mex'));
first = robot.initial();
printf('initial: %g %g %d\n', first.j(2).target, first.gain, numel(first.lamps));
first.j(2).target = -1;
first.big = intmax('uint64');
first.lamps = [true true false];
first.status.heat = 1.5;
robot.write(first);
shot = robot.snapshot(false);
printf('written: %d %d %.1f %d\n', shot.big == intmax('uint64'), sum(shot.lamps), shot.status.heat, numel(shot.j));
robot.lamps(3) = true;
printf('lamps: %d %d %d\n', robot.lamps);
robot.j(2).mode = 0;
told('consistent', @() robot.j(1).snapshot(true));
shown = evalc('disp(robot)');
printf('shown: %d\n', ~isempty(strfind(shown, 'published_pose')));
cycle = robot.cycle('targets');
cycle.exchange([0.5 0.25]);
told('closed cycle', @() cycle.close());
told('used after', @() cycle.exchange([0.5 0.25]));
robot.published_pose.start();
robot.published_pose.start();
rows.time_s = [];
while numel(rows.time_s) < 20
  robot.published_pose.wait(10);
  more = robot.published_pose.poll();
  rows.time_s = [rows.time_s; more.time_s];
  rows.j_0_pos = more.j_0_pos;
end
printf('rows: %d %d %.3f %d\n', issorted(rows.time_s), iscolumn(rows.time_s), rows.j_0_pos(1), ...
       robot.published_pose.lost());
told('no timetable', @() robot.published_pose.timetable());
robot.published_pose.stop();
joint = robot.j(1);

typed_robot = typed.Typed(given{2});
typed_robot.j(3).torque = 1.5;
flags = typed_robot.flags;
typed_robot.clear_flags(struct('ready', true, 'mode', typed.Mode.idle, 'heat', 15));
typed_robot.all = struct('j_0_target', 0.1, 'j_1_target', 0.2, 'j_2_target', 0.3);
typed_robot.all = [0.1 0.2 0.3];
printf('typed: %s %d %d\n', class(typed_robot.uptime), flags.ready, typed.Mode.class_);
clear typed_robot
fflush(stdout);

puts("ready\n");
fflush(stdout);
fgetl(stdin);
told('lost', @() robot.small);
told('lost write', @() put(robot, 'small', 1));
robot.close();
robot.close();
told('closed', @() joint.pos);
printf('unlocked: %d\n', ~mislocked('unitylink_mex'));
