// The live verdicts of a page on films from the standard input, as JSON: node verdict.js LIVE_FOLDER. See
// browser_verdict_test.cpp.
"use strict";
const fs = require("fs");
globalThis.live = {};
require(`${process.argv[2]}/verdict.js`);

const {reference, films} = JSON.parse(fs.readFileSync(0, "utf8"));
const verdict = new live.statistics.LiveVerdict(reference, films[0].width, films[0].height);
const results = films.map(film => {
    verdict.add(film);
    const {differences, smallestDetectable, map, isBiased} = verdict.verdict;
    return {
        text: verdict.text,
        smallestDetectable,
        map,
        isBiased,
        values: differences.map(d => d.value),
        errors: differences.map(d => d.standardError)
    };
});
process.stdout.write(JSON.stringify(results));
