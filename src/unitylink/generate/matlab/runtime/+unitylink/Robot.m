% SPDX-License-Identifier: BSD-3-Clause
classdef Robot < unitylink.Part
  % A robot on its links.
  methods
    function close(self)
      % Close the links. Twice does nothing. clear does it, too, when no part is in use any more.
      self.ul_session.close();
    end
    function why = unverified(self)
      % Return why it is not known that the gateware has this spec, or '' if it was verified.
      why = unitylink_mex('unverified', self.ul_session.number);
    end
    function set_dead_man(self, silence_s)
      % After this silence of the program, the gateware makes the outputs safe. 0: never.
      unitylink_mex('dead_man', self.ul_session.number, silence_s);
    end
    function arm(self)
      % Allow writes again after the dead-man has tripped.
      unitylink_mex('arm', self.ul_session.number);
    end
  end
end
