// Bundles the page into scenic/playground/static, where `scenic playground` and wheels find it.
import { build } from "esbuild";
import { copyFile, mkdir, rm } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const output = join(here, "..", "..", "scenic", "playground", "static");
const monaco = join(here, "node_modules", "monaco-editor");

await rm(output, { recursive: true, force: true });
await mkdir(output, { recursive: true });
const shared = { bundle: true, minify: true, format: "iife", target: "es2022", logLevel: "warning" };
await build({
  ...shared,
  entryPoints: [join(here, "src", "page.js")],
  outfile: join(output, "page.js"),
  loader: { ".ttf": "file" },
  assetNames: "[name]",
  alias: {
    "monaco-lsp-client": join(monaco, "esm", "external", "monaco-lsp-client", "out", "index.js"),
  },
});
await build({
  ...shared,
  entryPoints: [join(monaco, "esm", "vs", "editor", "editor.worker.js")],
  outfile: join(output, "worker.js"),
});
await copyFile(join(here, "src", "page.html"), join(output, "page.html"));
await copyFile(join(monaco, "LICENSE"), join(output, "LICENSE.monaco-editor.txt"));
await copyFile(join(monaco, "ThirdPartyNotices.txt"), join(output, "NOTICES.monaco-editor.txt"));
