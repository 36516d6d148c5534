// Finds the command eng: on the path, or beside the Python of an environment, where `pip install englang` puts it.
const fs = require("fs");
const path = require("path");

function isFile(file) {
    try {
        return fs.statSync(file).isFile();
    } catch {
        return false;
    }
}

// The file of a command in the first folder that has it.
function inFolders(command, folders, windows) {
    const names = windows ? [`${command}.exe`, command] : [command];
    for (const folder of folders.filter((folder) => folder)) {
        const found = names.map((name) => path.join(folder, name)).find(isFile);
        if (found) {
            return found;
        }
    }
    return undefined;
}

// A stated command counts as it is. Otherwise eng of the path, then of the environment of one of the Pythons.
function find({ stated, pathVariable, pythons, windows }) {
    if (stated && stated !== "eng") {
        return stated;
    }
    const ofPath = (pathVariable || "").split(windows ? ";" : ":");
    const known = pythons.filter((python) => python);
    // on Windows pip puts commands into a folder beside the interpreter
    const ofPythons = known.flatMap((python) => {
        const folder = path.dirname(python);
        return windows ? [folder, path.join(folder, "Scripts")] : [folder];
    });
    return inFolders("eng", ofPath, windows) || inFolders("eng", ofPythons, windows);
}

// The interpreter of an environment in a folder.
function pythonOf(folder, windows) {
    return windows ? path.join(folder, "Scripts", "python.exe") : path.join(folder, "bin", "python");
}

// A word of a command line in quotes, for shells of Unix and for PowerShell.
function quoted(word, windows) {
    return windows ? `'${word.replace(/'/g, "''")}'` : `'${word.replace(/'/g, "'\\''")}'`;
}

// A command line. PowerShell calls a command in quotes by `&`.
function commandLine(words, windows) {
    const line = words.map((word) => quoted(word, windows)).join(" ");
    return windows ? `& ${line}` : line;
}

module.exports = { find, pythonOf, commandLine };
