// Prints the report of the Khronos glTF validator on a file; ends with 77 where the validator is missing.
// It is found by NODE_PATH, which install-tools.sh says.
const { readFileSync } = require("node:fs");

let validator;
try {
  validator = require("gltf-validator");
} catch {
  process.exit(77);
}
validator
  .validateBytes(new Uint8Array(readFileSync(process.argv[2])))
  .then((report) => console.log(JSON.stringify(report)))
  .catch((error) => {
    console.error(error);
    process.exit(1);
  });
