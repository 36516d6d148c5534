// Prints the examples of the page as JSON: { "name", "title", "text", "files" } of each. Files are the tables that the text reads.
import { readFileSync } from "node:fs";

// texts that run in a browser within seconds, the simplest first
const EXAMPLES = [
    ["swing", "examples/swing/swing.eng"],
    ["slider-crank", "examples/slider_crank/slider_crank.eng"],
    ["squeezing mechanism", "examples/squeezer/squeezer.eng"],
    ["valve train", "examples/valvetrain/valvetrain.eng"],
    ["boxer twin", "examples/boxer_twin/boxer_twin.eng"],
    ["V twin", "examples/v_twin/v_twin.eng"],
    ["first concept of an engine", "examples/concept/quick.eng"],
    ["inline four", "examples/inline4/inline4.eng", "examples/inline4/pressure.csv"],
];

const root = new URL("..", import.meta.url);
const read = (path) => readFileSync(new URL(path, root), "utf8");
const base = (path) => path.split("/").at(-1);
const examples = EXAMPLES.map(([title, path, ...files]) => ({
    title,
    name: base(path),
    text: read(path),
    files: Object.fromEntries(files.map((file) => [base(file), read(file)])),
}));
process.stdout.write(JSON.stringify(examples));
