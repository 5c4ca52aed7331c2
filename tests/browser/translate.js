// Translates shaders for WebGL as a page does: node translate.js LIVE_FOLDER < JSON, with {sources, jobs: [{file, chapter, texts,
// defines, isRecorder, main}]}. `texts` replaces or adds sources; `main` is the program, if it does not render. A job of which
// the translation itself fails gets the message as its text.
"use strict";
const fs = require("fs");
globalThis.live = {};
for (const name of ["preprocessor", "layout", "translation", "glsl"]) require(`${process.argv[2]}/${name}.js`);

const {sources, jobs} = JSON.parse(fs.readFileSync(0, "utf8"));
const texture = {
    binding: new live.Layout(sources["shaders/interface.h"]).constants.BINDING_TEXTURES,
    first: 0,
    width: 1,
    height: 1
};
for (const {file, chapter, texts, defines, isRecorder, main} of jobs) {
    let text;
    try {
        const job = {sources: {...sources, ...texts}, chapter, defines, main, scene: {buffers: [], images: [texture]}};
        const translated = live.glsl.translate({...job, ...(isRecorder && live.glsl.recorderOf(job.sources, chapter))});
        const lines = translated.text.split("\n").map((line, i) => {
            const place = translated.place(i + 1);
            return place ? `${line}  // ${place.file}:${place.line}` : line;
        });
        text = lines.join("\n");
    } catch (error) { text = `#error ${error.message}\n`; }
    fs.writeFileSync(file, text);
}
