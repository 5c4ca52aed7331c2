// What an experiment has shown, as in tools/check/facts.py: a test gives the same numbers to both. Laws are left to ./lab check.
"use strict";

live.facts = (() => {
    const BLOCKS = 16;  // of pixels: their spread gives the error of a variance
    const mean = values => values.reduce((sum, value) => sum + value, 0) / values.length;
    const variance = values => {
        const middle = mean(values);
        return values.reduce((sum, value) => sum + (value - middle) ** 2, 0) / (values.length - 1);
    };

    // What a film shows at a point, whose pixels all show the same: {mean, error, invalid}.
    function look(film, channel) {
        const pixels = Array.from({length: film.width * film.height}, (_, i) => {
            const [red, green, blue] = film.sums.subarray(3 * i, 3 * i + 3);
            return (channel === null ? (red + green + blue) / 3 : film.sums[3 * i + channel]) / film.samples;
        });
        const size = pixels.length / BLOCKS;
        const blocks = Array.from({length: BLOCKS}, (_, i) => variance(pixels.slice(i * size, (i + 1) * size)));
        const spread = Math.sqrt(variance(blocks) / BLOCKS);
        return {mean: mean(pixels), error: Math.sqrt((variance(pixels) + 2 * spread) / pixels.length), invalid: film.invalid};
    }

    // What several films of a point show.
    function together(sights) {
        const means = sights.map(sight => sight.mean), spread = means.length > 1 ? Math.sqrt(variance(means)) : 0;
        return {
            mean: mean(means),
            error: Math.max(mean(sights.map(sight => sight.error)), spread) / Math.sqrt(means.length),
            invalid: sights.reduce((sum, sight) => sum + sight.invalid, 0)
        };
    }

    // The fact that the points of an experiment and their sights make: {isRight, sentence}; the sentence is empty if all is
    // right.
    function fact({subject, varies, points}, sights, rules) {
        const {SURE, TOLERANCE, CLOSE, INTERVAL, DARK, FEW_PARTS, CONSTANTS} = rules;
        const brightest = Math.max(...points.map(point => Math.abs(point.mean)));
        const readings = points.map((point, i) => {
            const isDark = Math.abs(point.mean) <= DARK * brightest, scale = isDark ? brightest : point.mean;
            const value = sights[i].mean / scale;
            const error = Math.hypot(sights[i].error, isDark ? 0 : value * point.error) / Math.abs(scale);
            const off = Math.abs(value - (isDark ? 0 : 1));
            const isRight = off <= SURE * error + TOLERANCE;
            return {at: point.at, value, error, isDark, isRight, isSurelyRight: isRight && off + INTERVAL * error <= CLOSE};
        });

        const number = ({value, error}) => {
            const width = INTERVAL * error;
            const decimals = width >= 0.1 * Math.max(value, 1) ? 1 : value >= 0.2 ? 2 : 3, step = 10 ** -decimals;
            if (value === 0 && width === 0) return "0";
            return `${value.toFixed(decimals)} ± ${(Math.max(Math.ceil(width / step - 0.5), 1) * step).toFixed(decimals)}`;
        };
        const constant = ({value, error}) => {
            const width = INTERVAL * error + 0.003 * value;
            const fitting = Object.keys(CONSTANTS).filter(name => Math.abs(value - CONSTANTS[name]) <= width);
            return fitting.length === 1 && width <= FEW_PARTS * value ? ` (as by a factor ${fitting[0]})` : "";
        };
        const commonValue = those => {
            const weights = those.map(({value, error}) => 1 / (error ** 2 + (0.004 * value) ** 2 + 1e-9));
            const sum = mean(weights) * weights.length;
            const value = those.reduce((total, reading, i) => total + weights[i] * reading.value, 0) / sum;
            const agree =
                those.every(reading => Math.abs(reading.value - value) <= 3 * reading.error + TOLERANCE * Math.max(value, 0.1));
            return agree ? {value, error: sum ** -0.5} : null;
        };

        const lit = readings.filter(reading => !reading.isDark), wrong = lit.filter(reading => !reading.isRight), words = [];
        const whatever = lit.length > 1 ? `, whatever ${varies}` : "", common = wrong.length ? commonValue(lit) : null;
        if (wrong.length && lit.every(({value}) => value === 0))
            words.push(`nothing of it is there${whatever}`);
        else if (common && wrong.length === lit.length)
            words.push(`${number(common)} times as bright as it should be${lit.length > 1 ? constant(common) : ""}${whatever}`);
        else if (wrong.length) {
            const told = wrong.map(reading => `${reading.at}: ${reading.value === 0 ? "nothing" : `${number(reading)} times`}`);
            const right = lit.filter(reading => reading.isSurelyRight).map(reading => reading.at);
            words.push(
                told.join(", ").replace(" times", " times as bright as it should be"),
                ...(right.length ? [`right: ${right.join(", ")}`] : []));
        }
        for (const reading of readings.filter(({isDark, isRight}) => isDark && !isRight))
            words.push(`light where none should be: ${reading.at}: ${number(reading)} times that of the brightest place`);
        const invalid = sights.reduce((sum, sight) => sum + sight.invalid, 0);
        const isRight = !invalid && readings.every(reading => reading.isRight);
        const sentence = `${subject}: ${words.join("; ") || "what is counted of it is right"}` +
            (invalid ? `; ${invalid} samples are infinite or not a number` : "");
        return {isRight, sentence: isRight ? "" : sentence, readings};
    }

    return {look, together, fact};
})();
