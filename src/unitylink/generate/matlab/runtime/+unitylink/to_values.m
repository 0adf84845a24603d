% SPDX-License-Identifier: BSD-3-Clause
function values = to_values(path, set, given)
  % Make the cell of a set's values from its struct. A set of plain values may also be a vector.
  if ~isstruct(given)
    plain = ~isempty(set.rows);
    for row = set.rows
      plain = plain && row{1}{2} == 0 && isempty(row{1}{3});
    end
    if ~plain || ~(isnumeric(given) || islogical(given)) || numel(given) ~= numel(set.places)
      error('unitylink:Argument', '%s: give a struct with its %d values; initial() makes one for a part', ...
            path, numel(set.places));
    end
    values = num2cell(given);
    return
  end
  values = taken(path, set, given, {});
end

function values = taken(path, set, given, values)
  if numel(given) ~= 1
    error('unitylink:Argument', '%s: one struct is expected, and %d were given; nothing was sent', path, numel(given));
  end
  for place = 1:numel(set.rows)
    [name, count, inner] = set.rows{place}{:};
    if ~isfield(given, name)
      error('unitylink:Argument', '%s: the field %s is missing in the struct; nothing was sent', path, name);
    end
    items = given.(name);
    if numel(items) ~= max(count, 1)
      error('unitylink:Range', '%s.%s: it has %d items, and %d were given; nothing was sent', path, name, ...
            max(count, 1), numel(items));
    end
    for item = 1:numel(items)
      if isempty(inner)
        values{end + 1, 1} = items(item);
      else
        values = taken([path '.' name], inner, items(item), values);
      end
    end
  end
  if numel(fieldnames(given)) > numel(set.rows)
    known = cellfun(@(row) row{1}, set.rows, 'UniformOutput', false);
    other = setdiff(fieldnames(given), known);
    error('unitylink:Argument', '%s: there is no output %s; nothing was sent', path, other{1});
  end
end
