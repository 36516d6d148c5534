// One instance of the module, for checks or for runs. The page ends this worker to stop a run.
import { Module } from "./module.js";

// time between two reports of progress (ms)
const BETWEEN = 100;

let compiled;
let module;
let began = 0;
let told = 0;
let seconds = Infinity;

function goesOn(fraction, steps) {
    const now = performance.now();
    if (now - told >= BETWEEN) {
        told = now;
        postMessage({ kind: "progress", fraction, steps });
    }
    return now - began < 1000 * seconds;
}

const WORK = {
    start: (message) => {
        ({ compiled } = message);
        return {};
    },
    check: ({ request }) => ({ found: module.check(request) }),
    run: (message) => {
        ({ seconds } = message);
        return module.run(message.request);
    },
    report: () => ({ report: module.report() }),
};

async function serve(message) {
    began = performance.now();
    told = began;
    try {
        if (message.kind !== "start") {
            module ??= await Module.of(compiled, goesOn);
        }
        const done = WORK[message.kind](message);
        const took = performance.now() - began;
        postMessage({ kind: "done", number: message.number, took, ...done }, done.numbers ? [done.numbers.buffer] : []);
    } catch (error) {
        const exhausted = error instanceof RangeError || /out of bounds|stack/.test(error.message);
        const reason = exhausted ? "the browser's stack or memory is exhausted; a text that nests deeply does this" : error.message;
        const cause = module?.fault ?? reason;
        module = undefined;
        postMessage({ kind: "fault", number: message.number, cause });
    }
}

// one after the other
let last = Promise.resolve();
addEventListener("message", ({ data }) => {
    last = last.then(() => serve(data));
});
