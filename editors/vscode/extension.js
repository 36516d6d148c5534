// Starts `eng lsp` for files of Eng, and runs analyses in a terminal.
const { Uri, commands, extensions, window, workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");
const { commandLine, find, pythonOf } = require("./find");

const windows = process.platform === "win32";
const INSTALL = "pip install englang";
const SETTING = "Set eng.command";

let client;

// The Python that the user has chosen in the Python extension, if that is installed.
async function chosenPython() {
    const python = extensions.getExtension("ms-python.python");
    if (!python) {
        return undefined;
    }
    try {
        const { environments } = await python.activate();
        const folder = workspace.workspaceFolders?.[0]?.uri;
        const chosen = environments.getActiveEnvironmentPath(folder);
        const resolved = await environments.resolveEnvironment(chosen);
        return resolved?.executable?.uri?.fsPath;
    } catch {
        // another version of that extension
        return undefined;
    }
}

// The chosen Python, that of an active environment, and those of environments in the folders that are open.
async function pythons() {
    const folders = (workspace.workspaceFolders || []).map((folder) => folder.uri.fsPath);
    const environments = [process.env.VIRTUAL_ENV, ...folders.map((folder) => `${folder}/.venv`)];
    const known = environments.filter((folder) => folder).map((folder) => pythonOf(folder, windows));
    return [await chosenPython(), ...known];
}

async function command() {
    const stated = workspace.getConfiguration("eng").get("command");
    return find({ stated, pathVariable: process.env.PATH, pythons: await pythons(), windows });
}

function inTerminal(words) {
    const terminal = window.terminals.find((terminal) => terminal.name === "eng") || window.createTerminal("eng");
    terminal.show();
    terminal.sendText(commandLine(words, windows));
}

async function offer(reason) {
    const chosen = await window.showWarningMessage(`${reason} Install it, then run "Eng: Restart".`, INSTALL, SETTING);
    if (chosen === INSTALL) {
        const python = (await chosenPython()) || (windows ? "python" : "python3");
        inTerminal([python, "-m", "pip", "install", "englang"]);
    } else if (chosen === SETTING) {
        commands.executeCommand("workbench.action.openSettings", "eng.command");
    }
}

async function start() {
    const found = await command();
    if (!found) {
        await offer("There is no command eng on the path or in the chosen Python environment.");
        return;
    }
    const server = { command: found, args: ["lsp"] };
    const documents = [{ scheme: "file", language: "eng" }, { scheme: "untitled", language: "eng" }];
    client = new LanguageClient("eng", "Eng", server, { documentSelector: documents });
    try {
        await client.start();
    } catch (error) {
        client = undefined;
        await offer(`${found} lsp does not start: ${error.message}.`);
    }
}

async function stop() {
    const running = client;
    client = undefined;
    await running?.stop();
}

// The command above an analysis.
async function run(uri, analysis) {
    const found = await command();
    if (!found) {
        await offer("There is no command eng on the path or in the chosen Python environment.");
        return;
    }
    const document = await workspace.openTextDocument(uri);
    await document.save();
    inTerminal([found, "run", document.uri.fsPath, "--analysis", analysis]);
}

async function activate(context) {
    context.subscriptions.push(
        commands.registerCommand("eng.run", async (uri, analysis) => {
            if (uri && analysis) {
                await run(Uri.parse(uri), analysis);
            }
        }),
        commands.registerCommand("eng.restart", async () => {
            await stop();
            await start();
        }),
    );
    // the offer waits for its reader, and the extension does not wait for the offer
    start();
}

module.exports = { activate, deactivate: stop };
