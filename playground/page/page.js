// The page: an editor whose text is checked after each pause in typing, and run on request.
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, indentUnit } from "@codemirror/language";
import { lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState } from "@codemirror/state";
import { EditorView, drawSelection, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import { element } from "./elements.js";
import examples from "./examples.json";
import { eng } from "./language.js";
import { fragmentOf, textOf } from "./link.js";
import { diagnosticsOf, listOf } from "./messages.js";
import { resultsOf } from "./results.js";
import { Service } from "./service.js";

// after the last key (ms)
const PAUSE = 250;

const at = (id) => document.getElementById(id);
const state = (text) => at("state").replaceChildren(text);
const setFragment = (fragment) => window.history.replaceState(null, "", fragment);

let example = examples[0];
let checks;
let runs;
let typed = 0;
let pause;
// whether the last checked text can run
let runnable = false;
// lines of the last check about models and analyses
let facts = [];

const request = (view) => ({ name: example.name, text: view.state.doc.toString(), files: example.files });

function show(messages) {
    const doc = view.state.doc;
    view.dispatch(setDiagnostics(view.state, diagnosticsOf(doc, example.name, messages)));
    const go = ({ from, to }) => {
        view.dispatch({ selection: { anchor: from, head: to }, scrollIntoView: true });
        view.focus();
    };
    const apply = (changes) => view.dispatch({ changes });
    at("messages").replaceChildren(...listOf(doc, example.name, messages, facts, { go, apply }));
}

// A text without a check cannot run, even if the text before could.
function unchecked(reason) {
    runnable = false;
    at("run").disabled = true;
    at("messages").replaceChildren(element("p", { class: "broken" }, reason));
}

async function check() {
    const asked = typed;
    const { fault, found, took, stopped } = await checks.ask({ kind: "check", request: request(view) });
    if (stopped || asked !== typed) {
        return;
    }
    if (fault) {
        unchecked(`The check ended: ${fault}`);
        return;
    }
    if (found.refused) {
        unchecked(found.refused);
        return;
    }
    ({ facts } = found);
    show(found.messages);
    runnable = found.messages.errors === 0 && found.analyses.length > 0;
    at("run").disabled = !runnable || runs.busy;
    if (!runs.busy) {
        state(`checked in ${Math.round(took)} ms`);
    }
}

function changed() {
    typed += 1;
    clearTimeout(pause);
    pause = setTimeout(check, PAUSE);
}

function running(is) {
    at("run").disabled = is || !runnable;
    at("stop").hidden = !is;
    at("progress").hidden = !is;
    at("progress").removeAttribute("value");
}

async function run() {
    if (runs.busy || at("run").disabled) {
        return;
    }
    const asked = typed;
    running(true);
    state("running…");
    const seconds = Number(at("limit").value);
    const done = await runs.ask({ kind: "run", request: request(view), seconds });
    running(false);
    if (done.stopped) {
        state("stopped");
        return;
    }
    if (done.fault) {
        state("failed");
        at("results").replaceChildren(element("p", { class: "broken" }, `The run ended: ${done.fault}`));
        return;
    }
    state(`ran in ${(done.took / 1000).toFixed(2)} s`);
    at("results").replaceChildren(...resultsOf(done.answer, done.numbers, openReport));
    if (asked === typed && done.answer.messages) {
        show(done.answer.messages);
    }
}

async function openReport() {
    state("making the page…");
    const { report, fault } = await runs.ask({ kind: "report" });
    const refused = fault ?? report?.refused ?? (report ? undefined : "run it again");
    state(refused ? `no page: ${refused}` : "");
    if (!refused) {
        at("page").querySelector("iframe").srcdoc = report;
        at("page").showModal();
    }
}

async function copyLink() {
    setFragment(await fragmentOf(view.state.doc.toString(), example.name));
    try {
        await navigator.clipboard.writeText(location.href);
        state("link copied");
    } catch {
        state("the address of this page is the link");
    }
}

// Another text. A run of the text before ends: its results would appear below this one.
function fill(text) {
    if (runs?.busy) {
        runs.stop();
    }
    view.setState(editorState(text));
    changed();
}

function editorState(doc) {
    const runs = { key: "Mod-Enter", run: () => (run(), true) };
    return EditorState.create({
        doc,
        extensions: [
            lineNumbers(),
            lintGutter(),
            history(),
            drawSelection(),
            bracketMatching(),
            highlightActiveLine(),
            highlightSelectionMatches(),
            indentUnit.of("    "),
            EditorState.tabSize.of(4),
            eng,
            EditorView.contentAttributes.of({ "aria-label": "Text of the model" }),
            EditorView.updateListener.of((update) => update.docChanged && changed()),
            keymap.of([runs, ...defaultKeymap, ...historyKeymap, ...searchKeymap, ...lintKeymap, indentWithTab]),
        ],
    });
}

const view = new EditorView({ parent: at("editor"), state: editorState("") });

async function open() {
    at("example").append(...examples.map(({ title }, index) => element("option", { value: String(index) }, title)));
    at("example").addEventListener("change", ({ target }) => {
        example = examples[Number(target.value)];
        setFragment("#");
        at("results").replaceChildren(element("p", { class: "hint" }, "Run the model to see its figures and numbers here."));
        fill(example.text);
    });
    at("run").addEventListener("click", run);
    at("stop").addEventListener("click", () => runs.stop());
    at("link").addEventListener("click", copyLink);
    at("page").addEventListener("close", () => at("page").querySelector("iframe").removeAttribute("srcdoc"));
    try {
        const compiled = await WebAssembly.compileStreaming(fetch("eng.wasm"));
        checks = new Service(compiled);
        runs = new Service(compiled, ({ fraction, steps }) => {
            at("progress").value = fraction;
            state(`running: ${steps} steps, ${(100 * fraction).toFixed(0)} %`);
        });
    } catch (error) {
        state(`the module cannot be loaded: ${error.message}`);
        return;
    }
    addEventListener("hashchange", load);
    await load();
}

// Shows the text of the link, else the first example.
async function load() {
    const linked = await textOf(location.hash);
    if (location.hash.startsWith("#t=") && !linked) {
        at("results").replaceChildren(element("p", { class: "broken" }, "The text of the link cannot be read: perhaps a part of the link is missing."));
    }
    const known = examples.findIndex(({ name }) => name === linked?.name);
    example = examples[Math.max(known, 0)];
    at("example").value = String(Math.max(known, 0));
    fill(linked?.text ?? example.text);
}

open();
