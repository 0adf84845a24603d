% SPDX-License-Identifier: BSD-3-Clause
classdef Cycle < handle
  % The body of a control loop: one message each way on a framed link.
  properties (SetAccess = private, Hidden)
    ul_session = [];
    ul_number = 0;
    ul_path = '';
    ul_outputs = [];
    ul_inputs = [];
  end
  methods
    function self = Cycle(session, path, first, outputs, inputs)
      self.ul_session = session;
      self.ul_path = path;
      self.ul_outputs = outputs;
      self.ul_inputs = inputs;
      self.ul_number = unitylink_mex('cycle', session.number, path, first, outputs.places, inputs.places);
    end
    function inputs = exchange(self, outputs)
      % Write all outputs, then read all inputs.
      values = cell(0, 1);
      if ~isempty(self.ul_outputs.places)
        values = unitylink.to_values(self.ul_path, self.ul_outputs, outputs);
      end
      inputs = unitylink.from_values(self.ul_inputs, unitylink_mex('exchange', self.ul_session.number, ...
                                                                   self.ul_number, values));
    end
    function close(self)
      % Give the words back to the device. Twice does nothing.
      if self.ul_number ~= 0 && self.ul_session.number ~= 0
        unitylink_mex('close_cycle', self.ul_session.number, self.ul_number);
      end
      self.ul_number = 0;
    end
    function delete(self)
      self.close();
    end
  end
end
