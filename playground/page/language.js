// Colours of Eng, from the grammar for editors (editors/vscode/syntaxes): its patterns are those of one line.
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from "@codemirror/language";
import { tags } from "@lezer/highlight";
import grammar from "./eng.tmLanguage.json";

// the beginning of a name of the grammar, and the style here
const STYLES = [
    ["comment.line.documentation", "docComment"],
    ["comment", "comment"],
    ["string", "string"],
    ["constant.character", "escape"],
    ["constant.numeric", "number"],
    ["constant.language", "bool"],
    ["support.type.unit", "unit"],
    ["storage", "definitionKeyword"],
    ["keyword.operator.eng", "operator"],
    ["keyword", "keyword"],
    ["entity.name.type", "typeName"],
    ["entity.name.function", "function"],
    ["variable.other.definition", "definition"],
    ["variable.parameter", "parameter"],
];
const styleOf = (name) => STYLES.find(([begin]) => name?.startsWith(begin))?.[1];

// patterns with `begin` and `end` (texts in quotes) are one piece here
function flat(patterns) {
    return patterns.flatMap((pattern) => {
        if (pattern.include) {
            const found = grammar.repository[pattern.include.slice(1)];
            return flat(found.match || found.begin ? [found] : found.patterns);
        }
        if (pattern.begin) {
            return [{ expression: /"(?:[^"\\]|\\.)*(?:"|$)/dg, styles: { 0: styleOf(pattern.name) } }];
        }
        const captures = Object.entries(pattern.captures ?? {}).map(([index, { name }]) => [index, styleOf(name)]);
        const styles = pattern.name ? { 0: styleOf(pattern.name) } : Object.fromEntries(captures);
        return [{ expression: new RegExp(pattern.match, "dg"), styles }];
    });
}
const PATTERNS = flat(grammar.patterns);

// The coloured pieces of a line: [from, to, style], in their order.
export function pieces(line) {
    const found = [];
    let at = 0;
    while (at < line.length) {
        let first;
        for (const { expression, styles } of PATTERNS) {
            expression.lastIndex = at;
            const match = expression.exec(line);
            // of patterns that match at one place the earlier one counts
            if (match && match[0].length > 0 && (!first || match.index < first.match.index)) {
                first = { match, styles };
            }
        }
        if (!first) {
            break;
        }
        for (const [index, style] of Object.entries(first.styles)) {
            const place = first.match.indices[index];
            if (place && style) {
                found.push([...place, style]);
            }
        }
        at = first.match.index + first.match[0].length;
    }
    return found;
}

const language = StreamLanguage.define({
    name: "eng",
    startState: () => ({ pieces: [] }),
    copyState: (state) => ({ pieces: state.pieces }),
    token(stream, state) {
        if (stream.sol()) {
            state.pieces = pieces(stream.string);
        }
        const next = state.pieces.find(([, to]) => to > stream.pos);
        if (!next) {
            stream.skipToEnd();
            return null;
        }
        const [from, to, style] = next;
        stream.pos = from > stream.pos ? from : to;
        return stream.pos === to ? style : null;
    },
    tokenTable: {
        docComment: tags.docComment,
        escape: tags.escape,
        unit: tags.unit,
        definitionKeyword: tags.definitionKeyword,
        function: tags.function(tags.variableName),
        definition: tags.definition(tags.variableName),
        parameter: tags.propertyName,
    },
    languageData: { commentTokens: { line: "//" }, closeBrackets: { brackets: ["(", "[", "{", '"'] } },
});

const colours = HighlightStyle.define([
    { tag: [tags.comment, tags.docComment], color: "#5c6a72" },
    { tag: tags.docComment, fontStyle: "italic" },
    { tag: tags.string, color: "#8a4b08" },
    { tag: tags.number, color: "#0b5394" },
    { tag: tags.unit, color: "#0b7285" },
    { tag: tags.bool, color: "#0b5394" },
    { tag: [tags.keyword, tags.definitionKeyword], color: "#8b1a62" },
    { tag: tags.typeName, color: "#1b5e20", fontWeight: "600" },
    { tag: tags.function(tags.variableName), color: "#1b5e20" },
    { tag: tags.propertyName, color: "#4a4a8a" },
]);

export const eng = [language, syntaxHighlighting(colours)];
