// Writes ThirdPartyNotices.txt, the licences of the modules that esbuild has put into the extension, beside a copy of our own
// licence. What is bundled is read off esbuild's report; a module without a licence ends the build.

import { copyFileSync, existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const bundled = new Set();
for (const input of Object.keys(JSON.parse(readFileSync("dist/meta.json", "utf8")).inputs)) {
    // The innermost package: node_modules/a/node_modules/@b/c/lib/d.js is of @b/c.
    const found = input.match(/^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//);
    if (found) {
        bundled.add(found[1]);
    }
}

const notices = [...bundled].sort().map((folder) => {
    const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    const files = readdirSync(folder).filter((name) => /^(licen[cs]e|copying|notice)/i.test(name)).sort();
    if (!about.license || !files.length) {
        throw new Error(`${folder} says nothing of its licence, so the extension cannot bundle it`);
    }
    const source = about.repository?.url ?? about.repository ?? about.homepage ?? "";
    const texts = files.map((name) => readFileSync(join(folder, name), "utf8").trim());
    return [`${about.name} ${about.version} (${about.license})`, source, "", ...texts].join("\n");
});

const line = "-".repeat(80);
const opening = "The extension contains the following software of others.";
writeFileSync("ThirdPartyNotices.txt", `${[opening, ...notices].join(`\n\n${line}\n\n`)}\n`);
if (existsSync("../../LICENSE")) {
    copyFileSync("../../LICENSE", "LICENSE.txt");
}
console.log(`notices of ${notices.length} modules`);
