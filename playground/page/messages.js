// Messages of Eng in the editor and below it. Their form is that of `eng check --format json`.
import { element } from "./elements.js";

// The place in the editor's text of a line and a column, which count from 1, columns in characters. A character may be two units here.
function position(doc, line, column) {
    const whole = doc.line(Math.min(Math.max(line, 1), doc.lines));
    const before = [...whole.text].slice(0, column - 1).join("");
    return whole.from + before.length;
}

// The range of a place in the editor's text; undefined for a place in another text.
export function rangeOf(doc, name, place) {
    if (place.file !== name || place.line === null) {
        return undefined;
    }
    const from = position(doc, place.line, place.column);
    return { from, to: Math.max(from, position(doc, place.end_line, place.end_column)) };
}

const same = (a, b) => a.file === b.file && a.start === b.start && a.end === b.end;
const change = (fix, range) => ({ from: range.from, to: range.to, insert: fix.replacement });

// The messages for the gutter and the underlines.
export function diagnosticsOf(doc, name, messages) {
    return messages.diagnostics.flatMap((message) => {
        const range = rangeOf(doc, name, message);
        if (!range) {
            return [];
        }
        const own = message.labels.filter((label) => label.primary && label.message);
        const lines = [message.title, ...own.map((label) => label.message), ...message.help.map((help) => `help: ${help}`)];
        const fixes = message.fixes.flatMap((fix) => {
            const place = rangeOf(doc, name, fix);
            return place ? [{ name: fix.title, apply: (view) => view.dispatch({ changes: change(fix, place) }) }] : [];
        });
        return [
            {
                ...range,
                severity: message.severity === "note" ? "info" : message.severity,
                source: message.code,
                message: lines.join("\n"),
                actions: fixes,
            },
        ];
    });
}

// The list below the editor. `go(range)` shows a place, `apply(change)` changes the text.
export function listOf(doc, name, messages, facts, { go, apply }) {
    const listed = messages.diagnostics.map((message) => {
        const place = (at) => {
            const range = rangeOf(doc, name, at);
            const text = `${at.file}:${at.line}:${at.column}`;
            return range ? element("button", { class: "place", type: "button", onclick: () => go(range) }, text) : element("span", {}, text);
        };
        const labels = message.labels.filter((label) => label.message);
        const fixes = message.fixes.flatMap((fix) => {
            const range = rangeOf(doc, name, fix);
            return range ? [element("button", { class: "fix", type: "button", onclick: () => apply(change(fix, range)) }, fix.title)] : [];
        });
        return element(
            "div",
            { class: `message ${message.severity}` },
            element("p", {}, element("span", { class: "code" }, `${message.severity} ${message.code}`), ` ${message.title} `, message.file ? place(message) : undefined),
            ...labels.map((label) => element("p", { class: "label" }, same(label, message) ? undefined : place(label), ` ${label.message}`)),
            ...message.notes.map((note) => element("p", { class: "note" }, `note: ${note}`)),
            ...message.help.map((help) => element("p", { class: "help" }, `help: ${help}`)),
            ...fixes,
        );
    });
    if (messages.more > 0) {
        listed.push(element("p", { class: "hint" }, `and ${messages.more} more`));
    }
    if (listed.length === 0) {
        listed.push(element("p", { class: "ok" }, "no errors, no warnings"));
    }
    if (facts.length > 0) {
        listed.push(element("pre", {}, facts.join("\n")));
    }
    return listed;
}
