// Run by `node --test editors/vscode/tests/find.test.js`.
const assert = require("node:assert");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { test } = require("node:test");
const { commandLine, find, pythonOf } = require("../find");

function folderWith(...files) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "eng-find-"));
    for (const file of files) {
        fs.mkdirSync(path.dirname(path.join(folder, file)), { recursive: true });
        fs.writeFileSync(path.join(folder, file), "");
    }
    return folder;
}

test("the path comes before the Python environment", () => {
    const onPath = folderWith("eng");
    const environment = folderWith("bin/eng", "bin/python");
    const pythons = [undefined, pythonOf(environment, false)];
    const empty = folderWith();
    const both = { stated: "eng", pathVariable: `${empty}:${onPath}`, pythons, windows: false };
    assert.equal(find(both), path.join(onPath, "eng"));
    assert.equal(find({ ...both, pathVariable: empty }), path.join(environment, "bin", "eng"));
    assert.equal(find({ ...both, pathVariable: undefined, pythons: [] }), undefined);
    assert.equal(find({ ...both, stated: "/own/eng" }), "/own/eng");
});

test("commands of Windows end with exe, beside the interpreter or in its folder of scripts", () => {
    for (const python of ["Scripts/python.exe", "python.exe"]) {
        const environment = folderWith("Scripts/eng.exe", python);
        const pythons = [path.join(environment, python)];
        const found = find({ stated: "eng", pathVariable: "", pythons, windows: true });
        assert.equal(found, path.join(environment, "Scripts", "eng.exe"));
    }
});

test("a folder with the name of the command is none", () => {
    const folder = folderWith("eng/file");
    assert.equal(find({ stated: "eng", pathVariable: folder, pythons: [], windows: false }), undefined);
});

test("words of a command line are quoted", () => {
    assert.equal(commandLine(["eng", "run", "my 'first'.eng"], false), `'eng' 'run' 'my '\\''first'\\''.eng'`);
    assert.equal(commandLine(["eng", "it's"], true), `& 'eng' 'it''s'`);
});
