// Loads what a page needs beside its scripts: the arrays of scenes, references, and experiments.
"use strict";

live.loading = (() => {
    async function unpack(base64) {
        const bytes = Uint8Array.from(atob(base64), character => character.charCodeAt(0));
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
        return new Response(stream).arrayBuffer();
    }

    const unpackWords = async packed => new Uint32Array(await unpack(packed));

    // Loads live/data/NAME.js once; a page from the disk may load scripts, but no other files.
    function loadData(folder, name) {
        if (live.data[name]) return Promise.resolve(live.data[name]);
        return new Promise((resolve, reject) => {
            const script = document.createElement("script");
            script.src = `${folder}data/${name}.js`;
            script.onload = () => live.data[name] ? resolve(live.data[name]) : reject(new Error(`${name}.js is damaged`));
            script.onerror = () => reject(new Error(`${name}.js is missing: the folder "live" belongs beside these pages`));
            document.head.append(script);
        });
    }

    function floatOfHalf(half) {
        const exponent = half >> 10 & 31, fraction = half & 1023;  // none is negative
        return exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15);
    }

    async function loadReference(folder, name) {
        const {width, height, samples, scales, packed} = await loadData(folder, name);
        const bytes = new Uint8Array(await unpack(packed)), count = 3 * width * height;
        const halves = Uint16Array.from({length: 2 * count}, (_, i) => bytes[i] | bytes[2 * count + i] << 8);
        const mean = Float64Array.from(halves.subarray(0, count), half => scales[0] * floatOfHalf(half));
        const variance = Float64Array.from(halves.subarray(count), half => (scales[1] * floatOfHalf(half)) ** 2);
        return {width, height, samples, mean, variance};
    }

    return {unpack, unpackWords, loadData, loadReference};
})();
