// The live verdict of common/statistics/live_verdict.cpp in JavaScript: a test feeds both the same films. The names are those of
// the C++ files, which explain the method.
"use strict";

live.statistics = (() => {
    const TILE = 8, FIRST_TEST = 16, POWER = 0.99, RELIABLE_PATHS = 1 << 17, TILE_FLOOR = 5e-4, RENDERER_ROUNDING = 1e-5;
    const ROUNDING_ERROR = 1e-6, FALSE_ALARMS = 1e-3;

    // Complementary error function: the series of erf for small x, else the continued fraction of Laplace, from its end.
    function erfc(x) {
        if (x < 0) return 2 - erfc(-x);
        if (x < 2) {
            let term = x, sum = x;
            for (let n = 1; Math.abs(term) > 1e-17 * sum; ++n) {
                term *= -x * x / n;
                sum += term / (2 * n + 1);
                if (n > 200) break;
            }
            return 1 - 2 / Math.sqrt(Math.PI) * sum;
        }
        let fraction = x;
        for (let k = 120; k > 0; --k) fraction = x + k / 2 / fraction;
        return Math.exp(-x * x) / (Math.sqrt(Math.PI) * fraction);
    }

    const normalPValue = z => erfc(Math.abs(z) / Math.SQRT2);

    function normalQuantile(probability) {
        if (probability > 0.5) return -normalQuantile(1 - probability);
        let z = -Math.sqrt(-2 * Math.log(probability));
        for (let step = 0; step < 60; ++step) {
            const density = Math.exp(-0.5 * z * z) / Math.sqrt(2 * Math.PI);
            const change = (0.5 * erfc(-z / Math.SQRT2) - probability) / density;
            z -= change;
            if (Math.abs(change) < 1e-14) break;
        }
        return z;
    }

    const sidak = (significance, count) => -Math.expm1(Math.log1p(-significance) / count);
    const wallaceFactor = freedom => (8 * freedom + 1) / (8 * freedom + 3);

    class Difference {
        constructor(value, standardError, freedom) { Object.assign(this, {value, standardError, freedom}); }
        get z() {
            if (this.value === 0) return 0;
            const t = this.value / this.standardError;
            return Math.sign(t) * wallaceFactor(this.freedom) * Math.sqrt(this.freedom * Math.log1p(t * t / this.freedom));
        }
        get pValue() { return normalPValue(this.z); }
        smallestDetectable(level, power) {
            const scaled = normalQuantile(0.5 * level) / wallaceFactor(this.freedom);
            const t = Math.sqrt(this.freedom * Math.expm1(scaled * scaled / this.freedom));
            return this.standardError * (t + normalQuantile(power) * Math.sqrt(1 + 0.5 * t * t / this.freedom));
        }
        relativeTo(scale) { return new Difference(this.value / scale, this.standardError / scale, this.freedom); }
    }

    function intervalText(difference) {
        const halfWidth = 1.96 * difference.standardError;
        const digits = Math.min(Math.max(Math.ceil(-Math.log10(Math.max(100 * halfWidth, 1e-9))), 0), 3);
        const value = (100 * difference.value).toFixed(digits);
        return `${value.startsWith("-") ? "" : "+"}${value} % ± ${(100 * halfWidth).toFixed(digits)} %`;
    }

    // The means of a film of so many samples, with its pixels averaged to the reference's.
    function meansOf(film, reference, samples) {
        const scale = film.width / reference.width, part = 1 / (scale * scale * samples);
        const means = new Float64Array(3 * reference.width * reference.height);
        for (let y = 0, i = 0; y < film.height; ++y)
            for (let x = 0; x < film.width; ++x, i += 3)
                for (let c = 0; c < 3; ++c)
                    means[3 * (Math.floor(y / scale) * reference.width + Math.floor(x / scale)) + c] += part * film.sums[i + c];
        return means;
    }

    // A film is {width, height, samples, sums}, three sums a pixel; a reference {width, height, samples, mean, variance}.
    class LiveVerdict {
        constructor(reference, width, height) {
            this.reference = reference;
            this.scale = width / reference.width;
            if (!Number.isInteger(this.scale) || height !== this.scale * reference.height)
                throw new Error("the reference has another size");
            this.tiles = [Math.ceil(reference.width / TILE), Math.ceil(reference.height / TILE)];
            this.nextSamples = FIRST_TEST;
            while (this.nextSamples * width * height < RELIABLE_PATHS) this.nextSamples *= 2;
            this.tests = 0;
            this.verdict = null;
        }

        add(film) {
            this.differences = meansOf(film, this.reference, this.nextSamples).map((mean, i) => mean - this.reference.mean[i]);
            this.samples = this.nextSamples;
            this.nextSamples *= 2;
            this.test();
        }

        // Of a square of tiles, or the image: the reference's mean and its variance, and the difference of a channel.
        difference(x, y, edge, channel) {
            const {reference, differences} = this;
            const right = Math.min((x + edge) * TILE, reference.width), bottom = Math.min((y + edge) * TILE, reference.height);
            const count = (right - x * TILE) * (bottom - y * TILE);
            let mean = 0, variance = 0, value = 0, spread = 0;
            const each = visit => {
                for (let v = y * TILE; v < bottom; ++v)
                    for (let u = x * TILE; u < right; ++u) visit(3 * (v * reference.width + u) + channel);
            };
            each(i => {
                mean += reference.mean[i] / count;
                variance += reference.variance[i] / (count * count);
                value += differences[i] / count;
            });
            each(i => {
                spread += (differences[i] - value) ** 2 / (count - 1);
            });
            if (count === 1) return {mean, difference: new Difference(0, Infinity, 1)};
            let error = spread / count;
            if (mean + value > 0) error *= Math.max(mean / (mean + value), 1);
            error = Math.max(error, variance * (reference.samples / (this.scale * this.scale)) / this.samples);
            return {mean, difference: new Difference(value, Math.sqrt(error + (RENDERER_ROUNDING * mean) ** 2), count - 1)};
        }

        finestReliableEdge() {
            const paths = (TILE * this.scale) ** 2 * this.samples;
            for (let edge = 1; edge < Math.max(...this.tiles); edge *= 2)
                if (edge * edge * paths >= RELIABLE_PATHS) return edge;
            return 0;
        }

        test() {
            const level = 0.5 * FALSE_ALARMS / ((this.tests + 1) * (this.tests + 2)), [columns, rows] = this.tiles;
            ++this.tests;
            const verdict = {
                samples: this.samples,
                isBiased: this.verdict?.isBiased ?? false,
                differences: [],
                smallestDetectable: [],
                map: [],
                tileSize: 0,
                tiles: 0,
                brightTiles: 0,
                darkTiles: 0
            };
            const scales = [0, 1, 2].map(channel => {
                const {mean, difference} = this.difference(0, 0, Math.max(columns, rows), channel), scale = mean > 0 ? mean : 1;
                const relative = difference.relativeTo(scale);
                verdict.differences.push(relative);
                verdict.smallestDetectable.push(relative.smallestDetectable(sidak(level, 3), POWER));
                verdict.isBiased ||= relative.pValue < sidak(level, 3);
                return scale;
            });
            const worst = (x, y, edge) => {
                const relative = scales.map((scale, channel) => {
                    const floor = TILE_FLOOR * scale, {mean, difference} = this.difference(x, y, edge, channel);
                    difference.standardError = Math.hypot(difference.standardError, floor);
                    return difference.relativeTo(Math.max(mean, floor));
                });
                return relative.reduce((a, b) => Math.abs(b.z) > Math.abs(a.z) ? b : a);
            };
            for (let y = 0; y < rows; ++y)
                for (let x = 0; x < columns; ++x) verdict.map.push(worst(x, y, 1).z);
            const edge = this.finestReliableEdge();
            if (edge > 0) {
                verdict.tileSize = edge * TILE * this.scale;
                verdict.tiles = Math.ceil(columns / edge) * Math.ceil(rows / edge);
                for (let y = 0; y < rows; y += edge)
                    for (let x = 0; x < columns; x += edge) {
                        const difference = worst(x, y, edge);
                        if (!(difference.pValue < sidak(level, 3 * verdict.tiles))) continue;
                        ++verdict[difference.value > 0 ? "brightTiles" : "darkTiles"];
                        verdict.isBiased = true;
                    }
            }
            this.verdict = verdict;
        }

        get text() {
            const v = this.verdict;
            if (!v) return `no verdict before ${this.nextSamples} samples a pixel`;
            const bias = Number((100 * Math.max(...v.smallestDetectable)).toPrecision(2));
            if (!v.isBiased) return `agrees with the reference: a bias above ${bias} % would show by now`;
            const channels = ["red", "green", "blue"].map((name, c) => `${name} ${intervalText(v.differences[c])}`);
            const text = `biased: ${channels.join(", ")}`;
            if (v.brightTiles + v.darkTiles === 0) return text;
            const where = `of ${v.tiles} tiles of ${v.tileSize} pixels`;
            return `${text}; ${where}, ${v.brightTiles} are too bright and ${v.darkTiles} too dark`;
        }
    }

    // The relative error of common/statistics/error_metrics.cpp, after the film's pixels are averaged to the reference's.
    function relativeError(film, reference) {
        const means = meansOf(film, reference, film.samples);
        const mean = reference.mean.reduce((sum, r) => sum + r, 0) / means.length;
        let error = 0, uncertainty = 0;
        means.forEach((value, i) => {
            const r = reference.mean[i], weight = mean > 0 ? 1 / (r * r + 0.01 * mean * mean) : 1;
            error += weight * (value - r) ** 2;
            uncertainty += weight * reference.variance[i];
        });
        return {error: Math.sqrt(Math.max(error - uncertainty, 0) / means.length), means};
    }

    return {LiveVerdict, relativeError, erfc, normalQuantile, normalPValue, sidak};
})();
