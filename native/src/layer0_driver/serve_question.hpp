// SPDX-License-Identifier: BSD-3-Clause
// A question to `unitylink serve` about a board: who is there, who may write, and giving that to others. It needs no
// connection to the board.
#pragma once

#include <string>

#include "layer0_driver/schemes.hpp"
#include "layer0_driver/status.hpp"
#include "layer0_driver/url.hpp"

namespace unitylink {

// Asks the server of a serve:// URL. The question is one line, and the answer one line of JSON. Errors: those of
// opening such a link.
[[nodiscard]] Outcome ask_server(const Url& url, const Patience& patience, const std::string& question,
                                 std::string& answer);

}  // namespace unitylink
