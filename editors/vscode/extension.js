// SPDX-License-Identifier: BSD-3-Clause
// Starts `unitylink lsp` and connects the editor to it. All that the editor shows comes from there.
const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function activate() {
  const command = workspace.getConfiguration("ulspec").get("command");
  const server = { command, args: ["lsp"] };
  client = new LanguageClient("ulspec", "UL-spec", server, { documentSelector: [{ language: "ulspec" }] });
  return client.start();
}

function deactivate() {
  return client && client.stop();
}

module.exports = { activate, deactivate };
