% SPDX-License-Identifier: BSD-3-Clause
classdef Session < handle
  % The links of an open robot. All parts of the robot share it. They are closed when nothing uses it any more.
  properties (SetAccess = private)
    number = 0;  % of the robot in unitylink_mex; 0: closed
  end
  methods
    function self = Session(tables, urls)
      self.number = unitylink_mex('open', tables, urls);
    end
    function close(self)
      % Close the links. Twice does nothing.
      if self.number ~= 0
        unitylink_mex('close', self.number);
        self.number = 0;
      end
    end
    function delete(self)
      self.close();
    end
  end
end
