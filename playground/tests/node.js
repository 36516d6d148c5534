// The module under Node against the native command: `node node.js SITE ENG EXAMPLES ROOT`, with the folder of
// the project. It prints times.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after } from "node:test";
import { asyncBufferFromFile, parquetMetadataAsync, parquetReadObjects } from "hyparquet";
import { Module, numbersOf } from "../page/module.js";
import { fragmentOf, textOf } from "../page/link.js";

const [site, eng, listing, root] = process.argv.slice(2);
const here = (file) => readFileSync(new URL(file, import.meta.url), "utf8");
const compiled = await WebAssembly.compile(readFileSync(join(site, "eng.wasm")));
const examples = JSON.parse(readFileSync(listing, "utf8")).map(({ name, text, files }) => ({ name, text, files }));
// films that are solved on cells
const further = [{ name: "films.eng", text: readFileSync(join(root, "tests/good/films.eng"), "utf8") }];
const folder = mkdtempSync(join(tmpdir(), "eng-playground-"));
after(() => rmSync(folder, { recursive: true }));

// Files of a text in a folder of its own, and the command there.
function native(request) {
    const own = mkdtempSync(join(folder, "model-"));
    for (const [name, text] of [[request.name, request.text], ...Object.entries(request.files ?? {})]) {
        writeFileSync(join(own, name), text);
    }
    return { own, command: (...words) => spawnSync(eng, words, { cwd: own, encoding: "utf8", env: { ...process.env, ENG_CACHE: "" } }) };
}

const bits = (numbers) => new BigUint64Array(Float64Array.from(numbers).buffer);

// Compares all columns of all analyses with the files of the command. Returns the number of the numbers.
async function sameBits(request) {
    const { own, command } = native(request);
    const start = performance.now();
    const ran = command("run", request.name, "--no-plots", "--quiet", "--out", "out");
    const natively = performance.now() - start;
    assert.ok(ran.status === 0 || ran.status === 1, ran.stderr);
    const module = await Module.of(compiled);
    const began = performance.now();
    const { answer, numbers } = module.run(request);
    const took = performance.now() - began;
    assert.equal(answer.refused, undefined);
    assert.equal(answer.stopped, null);
    assert.notEqual(answer.analyses.length, 0);
    let compared = 0;
    for (const analysis of answer.analyses) {
        assert.equal(analysis.failure, null);
        const stem = analysis.name.replace(/[^A-Za-z0-9_.\-[\]]/g, "_");
        const file = await asyncBufferFromFile(join(own, "out", `${stem}.parquet`));
        const { schema } = await parquetMetadataAsync(file);
        const names = schema.filter((entry) => entry.type === "DOUBLE").map((entry) => entry.name);
        assert.deepEqual(analysis.columns.map((column) => column.path), names);
        const rows = await parquetReadObjects({ file });
        for (const column of analysis.columns) {
            const due = rows.map((row) => row[column.path]);
            assert.deepEqual(bits(numbersOf(column, numbers)), bits(due), `${request.name}: ${analysis.name}, ${column.path}`);
            compared += due.length;
        }
    }
    return { compared, took, natively, answer };
}

test("a thousand steps of a pendulum have the bits of the native command", async () => {
    const request = { name: "steps.eng", text: here("steps.eng") };
    const { compared, answer } = await sameBits(request);
    assert.equal(answer.analyses[0].columns[0].count, 1001);
    // a run without its check, by the difference of two lengths
    const module = await Module.of(compiled);
    const timed = (duration) => {
        const text = request.text.replace("duration: 1 s", `duration: ${duration} s`);
        const began = performance.now();
        module.run({ ...request, text });
        return performance.now() - began;
    };
    timed(1);
    const step = (timed(11) - timed(1)) / 10_000;
    console.log(`pendulum: ${compared} numbers equal, ${step.toFixed(4)} ms a step with its sample`);
});

for (const example of [...further, ...examples]) {
    test(`${example.name} has the bits of the native command`, async () => {
        const { compared, took, natively } = await sameBits(example);
        const [here, there] = [took, natively].map((time) => (time / 1000).toFixed(2));
        console.log(`${example.name}: ${compared} numbers equal, check and run ${here} s, by the command ${there} s`);
    });
}

test("messages are those of `eng check --format json`", async () => {
    const module = await Module.of(compiled);
    const texts = ["faulty.eng", "idle.eng"].map((name) => ({ name, text: here(name) }));
    for (const request of [...texts, ...further, ...examples]) {
        const due = JSON.parse(native(request).command("check", request.name, "--format", "json").stdout);
        const began = performance.now();
        const { messages } = module.check(request);
        const took = performance.now() - began;
        assert.deepEqual(messages, due, request.name);
        console.log(`${request.name}: ${messages.diagnostics.length} messages equal, checked in ${took.toFixed(0)} ms`);
    }
});

test("the page ends a run, and reads the results up to there", async () => {
    let asked = 0;
    const module = await Module.of(compiled, () => (asked += 1) < 200);
    const { answer, numbers } = module.run({ name: "steps.eng", text: here("steps.eng") });
    assert.match(answer.stopped, /^stopped at 20\.0 % of the run/);
    const [time] = answer.analyses[0].columns;
    assert.ok(Math.abs(numbersOf(time, numbers).length - 201) <= 1);
    assert.match(module.report(), /^<!DOCTYPE html>/i);
});

test("memory stays as large as it is", async () => {
    const module = await Module.of(compiled);
    const request = { name: "faulty.eng", text: here("faulty.eng") };
    const used = () => module.exports.memory.buffer.byteLength;
    for (let count = 0; count < 20; count += 1) {
        module.check(request);
    }
    const before = used();
    for (let count = 0; count < 200; count += 1) {
        module.check(request);
    }
    assert.equal(used(), before);
    console.log(`memory after 220 checks: ${(before / 2 ** 20).toFixed(1)} MB`);
});

test("a text that nests too deeply is refused, or ends its own instance alone", async () => {
    const nested = (depth) => `model A { const x = ${"(".repeat(depth)}1${")".repeat(depth)} }`;
    const outcomes = [];
    for (const depth of [50, 200, 100_000]) {
        const module = await Module.of(compiled);
        try {
            outcomes.push(module.check({ name: "a.eng", text: nested(depth) }).messages.errors > 0 ? "told" : "right");
        } catch (error) {
            assert.ok(error instanceof RangeError || error instanceof WebAssembly.RuntimeError);
            outcomes.push("ended");
        }
    }
    assert.equal(outcomes[0], "right");
    console.log(`50, 200 and 100,000 parentheses: ${outcomes.join(", ")}`);
    const module = await Module.of(compiled);
    assert.equal(module.check({ name: "a.eng", text: nested(3) }).messages.errors, 0);
});

test("a link carries the text", async () => {
    const text = here("faulty.eng");
    const fragment = await fragmentOf(text, "faulty.eng");
    assert.match(fragment, /^#t=[\w-]+&f=faulty\.eng$/);
    assert.deepEqual(await textOf(fragment), { text, name: "faulty.eng" });
    assert.equal(await textOf("#t=%%"), undefined);
    assert.equal(await textOf("#"), undefined);
});

console.log(execFileSync(eng, ["--version"], { encoding: "utf8" }).trim());
