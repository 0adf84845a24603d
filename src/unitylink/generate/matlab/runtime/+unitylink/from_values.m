% SPDX-License-Identifier: BSD-3-Clause
function made = from_values(set, values)
  % Make the struct of a set from the cell of its values.
  [made, ~] = filled(set, values, 0);
end

function [made, at] = filled(set, values, at)
  made = struct();
  for row = set.rows
    [name, count, inner] = row{1}{:};
    items = cell(1, max(count, 1));
    for item = 1:numel(items)
      if isempty(inner)
        at = at + 1;
        items{item} = values{at};
      else
        [items{item}, at] = filled(inner, values, at);
      end
    end
    made.(name) = [items{:}];
  end
end
