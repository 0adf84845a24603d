% SPDX-License-Identifier: BSD-3-Clause
function unitylink_toolbox(version)
  % Package this folder as a toolbox of MATLAB: unitylink.mltbx, which others install by a double click.
  %
  % Run unitylink_build first, on each platform that the toolbox is for. Needs MATLAB R2023a. This function was
  % written to MATLAB's documents and was never run in MATLAB. Octave has no such toolboxes.
  if exist('OCTAVE_VERSION', 'builtin')
    error('unitylink:Argument', 'toolboxes are of MATLAB; in Octave, addpath this folder');
  end
  here = fileparts(mfilename('fullpath'));
  if isempty(dir(fullfile(here, ['unitylink_mex.' mexext])))
    error('unitylink:NotFound', 'unitylink_mex is not compiled: run unitylink_build first');
  end
  options = matlab.addons.toolbox.ToolboxOptions(here, 'b4c8c3a2-7b0e-4d39-9c5b-0d7c7b6f6e11');
  options.ToolboxName = 'Unity-Link';
  options.ToolboxVersion = version;
  options.Summary = 'Robots on FPGA boards, as objects of their spec';
  options.ToolboxMatlabPath = here;
  options.OutputFile = fullfile(here, 'unitylink.mltbx');
  options.SupportedPlatforms.MatlabOnline = false;
  options.MinimumMatlabRelease = 'R2023a';
  matlab.addons.toolbox.packageToolbox(options);
end
