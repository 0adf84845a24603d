% SPDX-License-Identifier: BSD-3-Clause
% Encodes and decodes numbers of the spec random.ul on a board of it, as codec.c does.
1;

function number = whole(text)
  % A number of 64 bits from its digits: a double does not hold all of them.
  negative = text(1) == '-';
  digits = ['000000000' text(1 + negative:end)];
  high = str2double(digits(1:end - 9));
  low = str2double(digits(end - 8:end));
  if negative
    number = -int64(high) * int64(1e9) - int64(low);
  else
    number = uint64(high) * uint64(1e9) + uint64(low);
  end
end

function show(number)
  if isfloat(number) || islogical(number) || abs(number) < 2 ^ 53
    printf('%.17g\n', double(number));
  elseif number < 0
    rest = rem(number, int64(1e9));
    printf('%d%09d\n', double((number - rest) / int64(1e9)), -double(rest));
  else
    rest = rem(number, 1e9);
    printf('%d%09d\n', double((number - rest) / 1e9), double(rest));
  end
end

given = argv();
robot = random.Random(given{1});
number = robot.ul_session.number;
questions = textscan(fread(stdin, Inf, 'char=>char')', '%s %f %s');
for i = 1:numel(questions{1})
  place = questions{2}(i);
  text = questions{3}{i};
  if strcmp(questions{1}{i}, 'd')
    show(unitylink_mex('decode', number, place, whole(text)));
    continue
  end
  if any(text == '.' | text == 'e' | text == 'n')
    value = str2double(text);
  else
    value = whole(text);
  end
  try
    show(unitylink_mex('encode', number, place, value));
  catch failure
    assert(failure.identifier, 'unitylink:Range');
    puts("-\n");
  end
end
