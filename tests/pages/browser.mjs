// The browser of the scripts here: playwright-core, where node finds it or in the folder that PLAYWRIGHT names, and chromium
// (CHROMIUM, by default /usr/bin/chromium). A script ends with exit code 77, skipped, where one of the two is missing.
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

export const skip = (why) => { console.log(`skipped: ${why}`); process.exit(77); };
const chromiumPath = process.env.CHROMIUM || "/usr/bin/chromium";
const require = createRequire(join(resolve(process.env.PLAYWRIGHT || "."), "x.js"));
let chromium;
try { ({ chromium } = require("playwright-core")); } catch { skip("playwright-core is not installed"); }
if (!existsSync(chromiumPath)) skip(`${chromiumPath} is not there`);

export const launch = () => chromium.launch({
  executablePath: chromiumPath,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});

/** The script of axe-core, where that lies beside playwright-core; otherwise empty, and nobody checks accessibility. */
export let axe = "";
try { axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8"); } catch { console.log("axe-core is not installed: accessibility is not checked"); }
