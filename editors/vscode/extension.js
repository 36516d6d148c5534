// Starts `eng lsp` for files of Eng.
const { workspace, window } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

async function activate() {
    const command = workspace.getConfiguration("eng").get("command") || "eng";
    const server = { command, args: ["lsp"] };
    const documents = [{ scheme: "file", language: "eng" }, { scheme: "untitled", language: "eng" }];
    client = new LanguageClient("eng", "Eng", server, { documentSelector: documents });
    try {
        await client.start();
    } catch (error) {
        window.showWarningMessage(`${command} lsp does not start: ${error.message}. Install eng, or set eng.command.`);
    }
}

function deactivate() {
    return client ? client.stop() : undefined;
}

module.exports = { activate, deactivate };
