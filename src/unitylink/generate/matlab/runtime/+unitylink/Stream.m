% SPDX-License-Identifier: BSD-3-Clause
classdef Stream < handle
  % Values that the gateware publishes together, by its own clock or on an event.
  properties (SetAccess = private, Hidden)
    ul_session = [];
    ul_number = 0;
    ul_path = '';
    ul_set = [];
    ul_divisor = 0;
  end
  methods
    function self = Stream(session, path, set, divisor)
      self.ul_session = session;
      self.ul_path = path;
      self.ul_set = set;
      self.ul_divisor = divisor;
    end
    function start(self, room)
      % Let the device publish. The last `room` publishes (4096) are kept until poll. Twice does nothing.
      if self.ul_number ~= 0
        return
      end
      if nargin < 2
        room = 4096;
      end
      self.ul_number = unitylink_mex('start', self.ul_session.number, self.ul_path, self.ul_set.places, ...
                                     self.ul_divisor, room);
    end
    function come = wait(self, timeout_s)
      % Wait for a publish. Return false if none came in time.
      come = unitylink_mex('wait', self.ul_session.number, self.ul_number, timeout_s);
    end
    function rows = poll(self, most)
      % Take the oldest publishes out. Return a struct with a column for each value, and for their times:
      % time_s, in seconds of the clock that never jumps (CLOCK_MONOTONIC).
      if nargin < 2
        most = 2 ^ 31;
      end
      [time_s, columns] = unitylink_mex('poll', self.ul_session.number, self.ul_number, most);
      rows = struct('time_s', time_s);
      for item = 1:numel(columns)
        rows.(self.ul_set.rows{item}{1}) = columns{item};
      end
    end
    function made = timetable(self, most)
      % The same as poll, as a timetable of MATLAB. Octave has none.
      if exist('OCTAVE_VERSION', 'builtin')
        error('unitylink:Argument', '%s: Octave has no timetable; use poll', self.ul_path);
      end
      if nargin < 2
        most = 2 ^ 31;
      end
      rows = self.poll(most);
      made = table2timetable(struct2table(rmfield(rows, 'time_s'), 'AsArray', false), ...
                             'RowTimes', seconds(rows.time_s));
    end
    function count = lost(self)
      % Return how many publishes were overwritten before poll took them, or lost on the line.
      count = unitylink_mex('lost', self.ul_session.number, self.ul_number);
    end
    function stop(self)
      % Stop the publishes. Twice does nothing.
      if self.ul_number ~= 0 && self.ul_session.number ~= 0
        unitylink_mex('stop', self.ul_session.number, self.ul_number);
      end
      self.ul_number = 0;
    end
    function delete(self)
      self.stop();
    end
  end
end
