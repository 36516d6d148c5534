// The answer of a run as elements: reports, figures, tables.
import { element } from "./elements.js";
import { numbersOf } from "./module.js";

// addresses of the shown figures, released with them
let addresses = [];

function address(text, type) {
    const made = URL.createObjectURL(new Blob([text], { type }));
    addresses.push(made);
    return made;
}

const missing = (title, reason) => element("p", { class: "missing" }, `${title}: ${reason}`);

// a picture of its own: names inside of two figures may be equal
function figure({ title, svg, missing: reason }, text) {
    if (svg === null) {
        return missing(title, reason);
    }
    const caption = text ? element("figcaption", { class: "text" }, text) : undefined;
    return element("figure", {}, element("img", { src: address(svg, "image/svg+xml"), alt: title }), caption);
}

function values(entry) {
    const row = (number) => {
        const name = number.name ? `${entry.title}, ${number.name}` : entry.title;
        return element("tr", { title: entry.text }, element("th", { scope: "row" }, name), element("td", {}, number.shown));
    };
    return element("table", { class: "values" }, element("tbody", {}, ...entry.numbers.map(row)));
}

function condition({ title, holds, advises, message }) {
    if (holds) {
        return element("p", { class: "holds" }, `✓ ${title}`);
    }
    return element("p", { class: advises ? "missing" : "broken" }, `${advises ? "warning" : "does not hold"}: ${message}`);
}

function entry(of) {
    switch (of.kind) {
        case "value":
            return values(of);
        case "figure":
            return figure(of, of.text);
        case "condition":
            return condition(of);
        default:
            return missing(of.title, of.reason);
    }
}

function report(of) {
    const text = of.text ? element("p", { class: "text" }, of.text) : undefined;
    return element("section", { class: "report" }, element("h2", {}, of.title || of.name), text, ...of.entries.map(entry));
}

// a number for a table on the screen
const short = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(6))) : String(value));
const quoted = (field) => (/[",\r\n]/.test(field) ? `"${field.replaceAll('"', '""')}"` : field);

// The columns as CSV: a row of paths, a row of units, then the numbers with all digits.
export function csv(columns, numbers) {
    const lists = columns.map((column) => numbersOf(column, numbers));
    const rows = [columns.map((column) => quoted(column.path)), columns.map((column) => quoted(column.unit))];
    for (let index = 0; index < (lists[0]?.length ?? 0); index += 1) {
        rows.push(lists.map((list) => String(list[index])));
    }
    return rows.map((row) => `${row.join(",")}\r\n`).join("");
}

function table(analysis, numbers) {
    const head = ["column", "unit", "first", "least", "largest", "last"];
    const rows = analysis.columns.map((column) => {
        const list = numbersOf(column, numbers);
        const finite = list.filter(Number.isFinite);
        const numbersShown = [list[0], finite.reduce((a, b) => Math.min(a, b), Infinity), finite.reduce((a, b) => Math.max(a, b), -Infinity), list.at(-1)];
        const cells = [column.unit, ...(list.length > 0 ? numbersShown.map(short) : [])];
        return element("tr", {}, element("th", { scope: "row" }, column.path), ...cells.map((cell) => element("td", {}, cell)));
    });
    const save = () => {
        const link = element("a", { href: address(csv(analysis.columns, numbers), "text/csv"), download: `${analysis.name}.csv` });
        link.click();
    };
    return element(
        "details",
        {},
        element("summary", {}, `${analysis.columns.length} columns of ${analysis.columns[0]?.count ?? 0} rows`),
        element("p", {}, element("button", { type: "button", class: "save", onclick: save }, "Save as CSV")),
        element("table", {}, element("thead", {}, element("tr", {}, ...head.map((cell) => element("th", { scope: "col" }, cell)))), element("tbody", {}, ...rows)),
    );
}

// Figures without a report are shown at once if the text has no report, else below a heading that opens them.
function analysis(of, numbers, hasReports) {
    const figures = of.figures.map((drawn) => figure(drawn));
    const shown = !hasReports || figures.length === 0 ? figures : [element("details", {}, element("summary", {}, `${figures.length} figures`), ...figures)];
    return element(
        "section",
        { class: "analysis" },
        element("h2", {}, of.name),
        of.failure === null ? undefined : element("p", { class: "broken" }, `ended early: ${of.failure}`),
        element("pre", {}, of.text),
        ...shown,
        table(of, numbers),
    );
}

// All results. `openReport()` shows the page of `eng report`.
export function resultsOf(answer, numbers, openReport) {
    addresses.forEach((old) => URL.revokeObjectURL(old));
    addresses = [];
    if (answer.refused) {
        return [element("p", { class: "broken" }, answer.refused)];
    }
    if (answer.messages.errors > 0 && answer.analyses.length === 0) {
        return [element("p", { class: "broken" }, "The text has errors; see the messages.")];
    }
    const open = element("button", { type: "button", id: "report", onclick: openReport }, "Page of the report");
    return [
        answer.stopped === null ? undefined : element("p", { class: "stopped" }, answer.stopped),
        answer.analyses.length === 0 ? undefined : element("p", {}, open),
        ...answer.reports.map(report),
        ...answer.sweeps.map((text) => element("pre", {}, text)),
        ...answer.missing.map(({ name, reason }) => missing(name, reason ?? "no results; see the messages")),
        ...answer.analyses.map((of) => analysis(of, numbers, answer.reports.length > 0)),
    ].filter((made) => made !== undefined);
}
