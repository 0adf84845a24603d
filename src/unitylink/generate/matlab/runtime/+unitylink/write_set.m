% SPDX-License-Identifier: BSD-3-Clause
function write_set(part, path, set, given)
  % Write the values of a set together.
  if isempty(set.places)
    error('unitylink:ReadOnly', '%s: it can only be read', path);
  end
  unitylink_mex('write_set', part.ul_session.number, path, part.ul_first, set.places, ...
                unitylink.to_values(path, set, given));
end
