// SPDX-License-Identifier: BSD-3-Clause
// The options of a robot (robot.hpp). Times are in seconds.
#pragma once

#include <string>

namespace unitylink {

struct RobotOptions {
  std::string url;
  double retry_s = 1.0;
  double command_timeout_s = 0.0;  // s without a set-point, after which the safe values are written; 0: never
  double deadman_s = 1.0;  // s without a sign of life, after which the gateware makes its outputs safe; 0: never
  bool safe_at_exit = true;
  bool armed = true;

  // The URL, with reconnect=1 added if it has no reconnect=. Not for `fd:` and `mmap:`, which a link cannot open again.
  [[nodiscard]] std::string lasting_url() const {
    if (url.find("reconnect=") != std::string::npos || url.rfind("fd:", 0) == 0 || url.rfind("mmap:", 0) == 0)
      return url;
    return url + (url.find('?') == std::string::npos ? "?" : "&") + "reconnect=1";
  }

  // Why a node cannot open the URL, or "": the virtual boards of Python have no driver in the core.
  [[nodiscard]] std::string refused() const {
    for (const char* scheme : {"sim:", "rtl:", "bit:"}) {
      if (url.rfind(scheme, 0) == 0)
        return url +
               ": the node in Python opens virtual boards, and with time=lockstep it publishes /clock "
               "(node:=node.py); this one cannot. Serve the board in real time, unitylink simulate SPEC.ul "
               "--tcp 5555, and give this node link:=tcp://127.0.0.1:5555";
    }
    return "";
  }
};

}  // namespace unitylink
