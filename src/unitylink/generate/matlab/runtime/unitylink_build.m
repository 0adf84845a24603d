% SPDX-License-Identifier: BSD-3-Clause
function unitylink_build(include, library)
  % Compile the MEX file beside this file. It is the same for every robot.
  %
  % unitylink_build()                  the library is installed where pkg-config finds it
  % unitylink_build(INCLUDE, LIBRARY)  the folders of unitylink.h and of libunitylink
  here = fileparts(mfilename('fullpath'));
  if nargin == 0
    [failed, include] = system('pkg-config --variable=includedir unitylink');
    if failed
      error('unitylink:NotFound', ['pkg-config does not find unitylink: install the library, or name its folders, ' ...
                                   'unitylink_build(INCLUDE, LIBRARY)']);
    end
    [~, library] = system('pkg-config --variable=libdir unitylink');
    include = strrep(strtrim(include), '\ ', ' ');  % it writes a space as in a shell
    library = strrep(strtrim(library), '\ ', ' ');
  elseif nargin ~= 2
    error('unitylink:Argument', 'give both folders, INCLUDE and LIBRARY, or none');
  end
  flags = {['-I' include], ['-L' library]};
  source = fullfile(here, 'mex', 'unitylink_mex.c');
  if exist('OCTAVE_VERSION', 'builtin')
    made = [tempname() '.' mexext()];  % mkoctfile puts no quotes around a folder with a space
    [told, failed] = mkoctfile('--mex', flags{:}, ['-Wl,-rpath,' library], '-lunitylink', '-o', made, source);
    if failed
      error('unitylink:Build', 'unitylink_mex did not compile: %s', told);
    end
    [moved, told] = movefile(made, fullfile(here, ['unitylink_mex.' mexext()]), 'f');
    if ~moved
      error('unitylink:Build', 'unitylink_mex cannot be written to %s: %s', here, told);
    end
  else
    if isunix()
      flags{end + 1} = ['LDFLAGS=$LDFLAGS -Wl,-rpath,' library];
    end
    mex(flags{:}, '-lunitylink', '-outdir', here, source);
  end
end
