// The paths that a page makes of events from the standard input, as JSON: node path.js LIVE_FOLDER. See
// browser_path_linux_test.cpp.
"use strict";
const fs = require("fs");
globalThis.live = {
    rendering: {}
};
for (const name of ["preprocessor", "layout", "path"]) require(`${process.argv[2]}/${name}.js`);

const {kinds, paths} = JSON.parse(fs.readFileSync(0, "utf8"));
process.stdout.write(JSON.stringify(paths.map(events => live.path.pathOf(events, kinds))));
