// What is drawn over a picture, and the plot of errors below it.
"use strict";

live.plot = (() => {
    const percent = error => `${Number((100 * error).toPrecision(2))} %`;

    // Red for positive, blue for negative, white for 0; saturated at 1.
    function signedColour(x) {
        x = Math.min(Math.max(x, -1), 1);
        return [1 + Math.min(x, 0), 1 - Math.abs(x), 1 - Math.max(x, 0)].map(part => Math.round(255 * part));
    }

    // What is not the picture itself: differences, the verdict's map, noise. One pixel of the overlay is one of the reference or
    // a tile.
    function drawOverlay(overlay, view, {film, reference, means, latest}) {
        overlay.hidden = !film || !["difference", "bias", "noise"].includes(view) || view !== "noise" && !reference ||
            view === "bias" && !latest.verdict;
        if (overlay.hidden) return;
        const meanOf = values => values.reduce((sum, value) => sum + value, 0) / values.length;
        const mean = reference ? meanOf(reference.mean) : meanOf(film.sums) / film.samples;
        const paint = (width, height, value) => {
            [overlay.width, overlay.height] = [width, height];
            const image = new ImageData(width, height);
            for (let i = 0; i < width * height; ++i) image.data.set([...signedColour(value(i)), 255], 4 * i);
            overlay.getContext("2d").putImageData(image, 0, 0);
        };
        const channels = (values, i) => (values[3 * i] + values[3 * i + 1] + values[3 * i + 2]) / 3;
        const difference = i =>
            2 * (channels(means, i) - channels(reference.mean, i)) / (channels(reference.mean, i) + 0.1 * mean);
        const noise = i =>
            Math.abs(channels(film.differences, i)) / (Math.abs(channels(film.sums, i)) + 0.1 * mean * film.samples);
        if (view === "difference") paint(reference.width, reference.height, difference);
        if (view === "noise") paint(film.width, film.height, noise);
        if (view === "bias") paint(...latest.tiles, i => latest.verdict.map[i] / 5);
    }

    // Errors over samples, both on logarithmic scales.
    function plotOf(errors) {
        const points = errors.filter(([samples, error]) => samples >= 2 && error > 0);
        if (points.length < 2) return "";
        const all = points.map(([, error]) => error), largest = Math.max(...all), smallest = Math.min(...all, largest / 8);
        const x = samples => 34 + 21 * Math.log2(samples);
        const y = error => 8 + 80 * Math.log(largest / error) / Math.log(largest / smallest);
        const ends = [points[0], points.at(-1)];
        const [first, last] = ends.map(([samples, error]) => `${percent(error)} after ${samples}`);
        const line = points.map(([samples, error]) => `${x(samples).toFixed(1)},${y(error).toFixed(1)}`).join(" ");
        const parts = [
            `<svg viewBox="0 0 300 110" role="img" aria-label="error against samples: ${first}, ${last}">`,
            `<polyline points="${line}"/>`,
            ...points.map(([samples, error]) => `<circle cx="${x(samples)}" cy="${y(error)}" r="2.5"/>`),
            ...ends.map(([, error]) => `<text x="2" y="${y(error) + 4}">${percent(error)}</text>`),
            ...ends.map(([samples]) => `<text x="${x(samples)}" y="106" text-anchor="middle">${samples}</text>`), "</svg>"
        ];
        return parts.join("");
    }

    return {percent, drawOverlay, plotOf};
})();
