// node live_engine.mjs ENGINE MODULE DATA CASES: the results of cases of the live page as JSON.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { runCases } from "./live_cases.mjs";

const [engineFile, moduleFile, dataFile, casesFile] = process.argv.slice(2);
const { createEngine } = await import(pathToFileURL(engineFile).href);
const json = (file) => JSON.parse(readFileSync(file, "utf8"));
const engine = await createEngine(readFileSync(moduleFile), json(dataFile));
console.log(runCases(engine, json(casesFile)));
