// Runs a file in a CPython of another version: node run.mjs 3.13 FILE LONGEST, with the repository at /scenic.
import { readFileSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const [version, file, longest] = process.argv.slice(2);
const home = `${here}/node_modules/python-${version}/`;
const { loadPyodide } = await import(`${home}pyodide.mjs`);
const python = await loadPyodide({ indexURL: home });
python.FS.mkdirTree("/scenic");
python.FS.mount(python.FS.filesystems.NODEFS, { root: resolve(here, "../..") }, "/scenic");
python.runPython(`import sys; sys.argv = ["", "${longest}"]`);
python.runPython(readFileSync(file, "utf-8"));
