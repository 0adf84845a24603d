% SPDX-License-Identifier: BSD-3-Clause
classdef Part < handle
  % A part of a robot, or the robot itself. unitylink generate makes a class of it for each constructor.
  properties (Hidden)
    ul_session = [];
    ul_first = 0;   % the place of its first value in the robot's table
    ul_path = '';
    ul_inputs = [];
    ul_outputs = [];
  end
  methods
    function values = snapshot(self, consistent)
      % Return all inputs together as a struct. With true, they are of one moment, or it is an error.
      values = unitylink.read_set(self, self.ul_path, self.ul_inputs, nargin > 1 && consistent);
    end
    function write(self, outputs)
      % Write all outputs together, from a struct as initial() returns it.
      unitylink.write_set(self, self.ul_path, self.ul_outputs, outputs);
    end
    function outputs = initial(self)
      % Return a struct of all outputs, with the INITIAL of the spec, or 0.
      set = self.ul_outputs;
      outputs = unitylink.from_values(set, unitylink_mex('initial', self.ul_session.number, self.ul_path, ...
                                                         self.ul_first, set.places));
    end
    function made = cycle(self, name)
      % Return the body of a control loop: it writes all outputs and reads all inputs. With a name: of this group.
      path = self.ul_path;
      inputs = self.ul_inputs;
      outputs = self.ul_outputs;
      if nargin > 1
        [path, inputs, outputs] = self.ul_group(name);
      end
      made = unitylink.Cycle(self.ul_session, path, self.ul_first, outputs, inputs);
    end
    function disp(self)
      % Show the names. The values are not read, because showing a thing must not use the line.
      if numel(self) ~= 1
        fprintf('  %d parts of class %s\n', numel(self), class(self));
        return
      end
      fprintf('  %s of class %s with\n', self.ul_path, class(self));
      names = properties(self);
      fprintf('    %s\n', names{:});
    end
  end
  methods (Hidden)
    function ul_begin(self, session, first, path, inputs, outputs)
      self.ul_session = session;
      self.ul_first = first;
      self.ul_path = path;
      self.ul_inputs = inputs;
      self.ul_outputs = outputs;
    end
    function value = ul_get(self, place)
      value = unitylink_mex('read', self.ul_session.number, self.ul_first + place);
    end
    function ul_put(self, place, value)
      unitylink_mex('write', self.ul_session.number, self.ul_first + place, value);
    end
    function values = ul_get_all(self, name, places)
      % An array of values: numbers as a row, packed values as a struct array.
      read = unitylink_mex('read_set', self.ul_session.number, name, self.ul_first, places, false);
      values = [read{:}];
    end
    function ul_put_all(self, name, places, values)
      if numel(values) ~= numel(places)
        error('unitylink:Range', '%s.%s: it has %d items, and %d were given; nothing was sent', ...
              self.ul_path, name, numel(places), numel(values));
      end
      given = cell(1, numel(values));
      for item = 1:numel(values)
        given{item} = values(item);
      end
      unitylink_mex('write_set', self.ul_session.number, name, self.ul_first, places, given);
    end
    function [path, inputs, outputs] = ul_group(self, name)
      error('unitylink:Argument', '%s: there is no group %s', self.ul_path, name);
    end
    function values = ul_get_group(self, name)
      [path, inputs, ~] = self.ul_group(name);
      values = unitylink.read_set(self, path, inputs, false);
    end
    function ul_put_group(self, name, outputs)
      [path, ~, set] = self.ul_group(name);
      unitylink.write_set(self, path, set, outputs);
    end
    function ul_write_only(self, name)
      error('unitylink:WriteOnly', '%s.%s: it can only be written', self.ul_path, name);
    end
    function ul_read_only(self, name, value)
      error('unitylink:ReadOnly', '%s.%s: it can only be read, or cleared if it has a method for that', ...
            self.ul_path, name);
    end
    function value = ul_same(self, name, old, value)
      % Let a part stay what it is. `robot.j1.pos_sp = 1` gives the part j1 back to robot in Octave.
      if isempty(old)
        return
      end
      same = strcmp(class(value), class(old)) && numel(value) == numel(old);
      for item = 1:numel(old)
        same = same && value(item).ul_first == old(item).ul_first;
      end
      if ~same
        error('unitylink:Argument', '%s.%s: it is a part of the robot; write its values', self.ul_path, name);
      end
      value = old;
    end
  end
end
