// What a page finds in films and experiments from the standard input, as JSON: node facts.js LIVE_FOLDER. See live_facts_test.py.
"use strict";
const fs = require("fs");
globalThis.live = {};
require(`${process.argv[2]}/facts.js`);

const {experiments, films, rules} = JSON.parse(fs.readFileSync(0, "utf8"));
process.stdout.write(JSON.stringify({
    facts: experiments.map(({sights, ...experiment}) => live.facts.fact(experiment, sights, rules)),
    sights: films.map(({sums, channel, ...film}) => live.facts.look({...film, sums: Float64Array.from(sums)}, channel)),
    together: live.facts.together(films.map(({sums, ...film}) => live.facts.look({...film, sums: Float64Array.from(sums)}, null)))
}));
