% SPDX-License-Identifier: BSD-3-Clause
function values = read_set(part, path, set, consistent)
  % Read the values of a set together, as a struct.
  if isempty(set.places)
    error('unitylink:WriteOnly', '%s: it can only be written', path);
  end
  values = unitylink.from_values(set, unitylink_mex('read_set', part.ul_session.number, path, part.ul_first, ...
                                                    set.places, consistent));
end
