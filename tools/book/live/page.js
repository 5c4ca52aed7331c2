// The live frame of a chapter's page: picture, verdict, error over samples, and the controls.
"use strict";
var live = globalThis.live ?? {};
globalThis.live = live;

live.page = (() => {
    const { element } = live, { Renderer, Rendering, loadData, loadReference, unpackWords } = live.rendering;
    const TYPING = 600;  // milliseconds after the last key until the picture starts again
    const MOST_SAMPLES = 4096;
    const ENOUGH = 16;  // samples of a picture that show that the device bears the shader
    const TURNS = 65536;  // that the loops of a sample may take if paths are short, as in shaders/engine/limited_loops.glsl
    const VIEWS = { picture: "picture", difference: "difference to the reference", bias: "bias in standard errors", noise: "noise",
                    ALBEDO: "albedo", NORMALS: "normals" };

    const percent = error => `${Number((100 * error).toPrecision(2))} %`;
    const isOfSurfaces = view => /^[A-Z]/.test(view ?? "");  // instead of radiance

    // Red for positive, blue for negative, white for 0; saturated at 1.
    function signedColour(x) {
        x = Math.min(Math.max(x, -1), 1);
        return [1 + Math.min(x, 0), 1 - Math.abs(x), 1 - Math.max(x, 0)].map(part => Math.round(255 * part));
    }

    class Frame {
        // `keepsTexts`: whether the reader's texts are read and stored.
        constructor(root, keepsTexts = true) {
            Object.assign(this, { root, keepsTexts, turn: 0, losses: 0, isVisible: true });
            this.chapter = root.dataset.chapter;
            this.about = live.chapters[this.chapter];
            this.isPaused = false;
            this.renderings = [];  // of this chapter, and perhaps of the one before
            this.bug = this.about.bugs[root.dataset.bug - 1];
            if (root.dataset.bug && !this.bug) return;  // a student's book has none
            root.append(element("button", { type: "button", class: "live-start", click: () => this.startByHand() }, this.bug ? "Find this bug here" : "Render this chapter here"),
                        element("p", {}, "It runs in your browser: edit the shader and see whether the picture is still right. Nothing is sent anywhere. ",
                                "The pictures are noisy at first, and the fan may start."));
        }

        // The button is gone afterwards: the keyboard goes on at the first control.
        async startByHand() {
            await this.start();
            this.root.querySelector(".live-controls select").focus({ preventScroll: true });
        }

        // A browser gives a page few contexts, and takes the oldest away: all frames draw on one canvas, which moves to the active one.
        static prepare() {
            if (Frame.renderer) return;
            Frame.canvas = element("canvas", { width: "256", height: "256", role: "img", "aria-label": "the picture as it renders" });
            Frame.renderer = new Renderer(Frame.canvas);
            Frame.canvas.addEventListener("webglcontextlost", event => {
                event.preventDefault();
                Frame.active?.lost();
            });
            Frame.canvas.addEventListener("webglcontextrestored", () => {
                Frame.renderer.make();
                Frame.active?.restored();
            });
        }

        // Makes this frame the one that renders. Returns whether the page has a device.
        activate() {
            if (!this.renderer) return false;
            if (Frame.active !== this) Frame.active?.stop();
            Frame.active = this;
            this.canvases.prepend(Frame.canvas);
            clearTimeout(this.timer);
            const isLost = this.renderer.gl.isContextLost();
            if (isLost) this.fail("The browser has taken the GPU away: reload the page if the picture does not come back.");
            return !isLost;
        }

        async start() {
            this.overlay = element("canvas", { class: "live-overlay", "aria-hidden": "true" });
            this.line = element("input", { type: "range", class: "live-line", min: "0", max: "100", value: "50", hidden: "",
                                           "aria-label": "the line between this chapter, left, and the one before", input: () => this.paint() });
            this.caption = element("p", { class: "live-numbers" });
            this.verdict = element("p", { class: "live-verdict", role: "status", "aria-live": "polite" }, "starting …");
            this.numbers = element("p", { class: "live-numbers" });
            this.note = element("p", { class: "live-note", role: "status" });
            this.edits = element("p", { class: "live-note live-edits", hidden: "" });
            this.plot = element("div", { class: "live-plot" });
            this.results = element("div", { class: "live-results", role: "status" });
            this.canvases = element("div", { class: "live-canvases" }, this.overlay, this.line);
            this.editor = new live.Editor(this.chapter, () => this.edited(), text => { this.note.textContent = text; }, this.keepsTexts);
            await this.editor.readLink();
            this.root.replaceChildren(this.controls(),
                element("div", { class: "live-columns" },
                    element("div", { class: "live-picture" }, this.edits, this.canvases, this.caption, this.verdict, this.plot, this.numbers, this.note),
                    this.editor.root), this.results);
            if (this.bug) {
                this.scene.value = Math.max(this.about.pictures.findIndex(({ name }) => name === this.root.dataset.picture), 0);
                this.plant(this.bug);
            }
            this.root.classList.add("live-running");
            this.showEdits();
            try {
                Frame.prepare();
            } catch (error) {
                this.fail(error.message);
                return;
            }
            this.renderer = Frame.renderer;
            if (this.renderer.device.isSlow) this.note.textContent ||= "This browser draws without a GPU: everything works, but slowly.";
            this.restart();
        }

        lost() {
            this.stopRenderings();
            this.fail(++this.losses > 1 ? "The browser took the GPU away again before the picture had got far. Make the shader smaller, then press Restart." :
                "The browser took the GPU away; starting again …");
        }

        restored() { if (this.losses < 2) this.restart(); }

        stop() {
            Frame.active = null;
            this.stopRenderings();
            clearTimeout(this.timer);
            this.verdict.textContent = "stopped: only one frame of a page renders at a time; Restart goes on with this one";
        }

        select(label, options, changed) {
            const list = element("select", { change: () => changed() }, ...options.map(([value, text]) => element("option", { value }, text)));
            return [list, element("label", {}, `${label} `, list)];
        }

        button(text, click) { return element("button", { type: "button", click }, text); }

        controls() {
            const { pictures, strategies, exercise, bugs } = this.about, restart = () => this.restart();
            const lengthText = name => `${name.replace(/_\d+$/, "").replaceAll("_", " ")}, up to ${name.replace(/.*_/, "")} bounces`;
            let strategyLabel, lengthLabel = element("label", {}, "Bounces "), sceneLabel, viewLabel;
            [this.scene, sceneLabel] = this.select("Scene", pictures.map(({ name }, i) => [i, lengthText(name)]), () => { this.length.value = ""; restart(); });
            [this.view, viewLabel] = this.select("Show", Object.entries(VIEWS), () => this.viewChanged());
            [this.strategy, strategyLabel] = this.select("Light by", strategies.map(name => [name, { both: "both", light: "light samples", bounces: "bounces" }[name]]), restart);
            this.length = element("input", { type: "number", min: "0", max: "100", step: "1", placeholder: "as above", change: restart });
            lengthLabel.append(this.length);
            this.compared = element("input", { type: "checkbox", change: restart });
            this.pause = this.button("Pause", () => this.setPaused(!this.isPaused));
            const bar = element("div", { class: "live-controls", role: "group", "aria-label": "controls of the picture" }, sceneLabel, viewLabel,
                                ...(strategies.length > 1 ? [strategyLabel] : []), lengthLabel,
                                ...(pictures.some(({ before }) => before) ? [element("label", {}, this.compared, " compare with the chapter before")] : []), this.pause, this.button("Restart", restart),
                                this.button("Check", () => this.check()));
            if (exercise) bar.append(this.button("Start exercise 1", () => this.editor.replace({ ...this.editor.state, [exercise.file]: exercise.text }, exercise.file)));
            if (bugs.length) {
                const numbers = [["", "none"], ...bugs.map((_, i) => [i, `number ${i + 1}`])];
                const [list, label] = this.select("Bug to find", numbers, () => this.plant(bugs[list.value]));
                bar.append(label);
            }
            bar.append(this.button("Original text", () => this.editor.replace({})), this.editor.back, this.button("Download", () => this.editor.download()),
                       this.button("Open", () => this.editor.openFile()), this.button("Copy a link", () => this.copyLink()));
            if (document.fullscreenEnabled) bar.append(this.button("Full window", () => document.fullscreenElement ? document.exitFullscreen() : this.root.requestFullscreen()));
            return bar;
        }

        // Puts a mistake into the chapter's own text; without one, the text that was there before the first.
        plant(bug) {
            const { editor } = this, file = bug && editor.files.find(path => live.sources[path].split(bug.find).length === 2);
            if (file) this.withoutBug ??= editor.state;
            editor.replace(file ? { [file]: live.sources[file].replace(bug.find, () => bug.replace) } : this.withoutBug ?? editor.state);
            if (!file) this.withoutBug = undefined;
        }

        // What the reader has changed, perhaps on another page.
        showEdits() {
            const names = this.editor.edited.map(file => {
                const [, folder, name] = /^chapters\/([^/]*)\/(.*)$/.exec(file);
                return `${name} of chapter ${parseInt(folder)}${folder === this.chapter ? "" : ", which that chapter's page has, too"}`;
            });
            this.edits.hidden = !names.length;
            this.edits.textContent = `Changed by you: ${names.join("; ")}. “Original text” undoes it.`;
        }

        edited() {
            this.showEdits();
            if (this.isPaused) this.note.textContent = "Paused: press Go on to see what your change does.";
            clearTimeout(this.timer);
            this.timer = setTimeout(() => this.restart(), TYPING);
        }

        setPaused(isPaused) {
            this.isPaused = isPaused;
            this.pause.textContent = isPaused ? "Go on" : "Pause";
            this.note.textContent = "";
        }

        async copyLink() {
            const link = await this.editor.link();
            try {
                await navigator.clipboard.writeText(link);
                this.note.textContent = "The link is copied: it contains your text.";
            } catch { this.note.replaceChildren("The browser does not let this page copy. Copy the link, which contains your text, from here: ", element("input", { readonly: "", value: link, "aria-label": "link" })); }
            if (link.length > 8000) this.note.append(" It is long, and some programs cut long links: rather download the text.");
        }

        fail(message) {
            this.verdict.className = "live-verdict live-failed";
            this.verdict.textContent = message;
        }

        get isView() { return isOfSurfaces(this.view.value); }

        viewChanged() {
            if (this.isView || this.shownView !== this.view.value && isOfSurfaces(this.shownView)) this.restart();
            else if (this.film) this.drawOverlay();
            this.shownView = this.view.value;
        }

        stopRenderings() {
            ++this.turn;
            for (const { rendering } of this.renderings) rendering.stop();
            this.renderings = [];
        }

        // The defines of the page's own options.
        get options() { return this.strategy.value ? [`STRATEGY STRATEGY_${this.strategy.value.toUpperCase()}`] : []; }

        // Compiles texts for a picture's scene. Throws ShaderErrors.
        async prepare({ scene, parameters: words, chapter = this.chapter, options = this.options }, sources) {
            if (typeof scene === "string") scene = await loadData(this.root.dataset.folder, scene);
            scene.words ??= await unpackWords(scene.packed);
            const parameters = Uint32Array.from(words), placeOf = member => this.renderer.layout.offsetOf("RenderParameters", member);
            const size = [...parameters.subarray(placeOf("image_size"), placeOf("image_size") + 2)];
            if (this.length.value !== "") parameters[placeOf("max_path_length")] = Math.min(Math.max(Math.round(this.length.value), 0), 100);
            const defines = [...scene.defines, ...options], named = {};
            if (this.isView) {
                defines.push(`VIEW_${this.view.value}`);
                Object.assign(named, { "path_trace.glsl": "shaders/observation/view.glsl", "sample_loop.glsl": "shaders/engine/sample_loop.glsl" });
            }
            const translated = live.glsl.translate({ sources, chapter, named, defines, scene });
            const started = performance.now(), linked = await this.renderer.compile(translated), compileTime = performance.now() - started;
            return { rendering: new Rendering(this.renderer, { translated, linked, scene, parameters, size }), translated, chapter, compileTime };
        }

        // Renders a picture; look(film, state, verdict) is called at powers of two. Returns whether it came to its end.
        async renderPicture(picture, target, look) {
            this.stopRenderings();
            const { turn, editor: { tooLong } } = this, started = performance.now(), { before } = picture;
            if (tooLong) throw new live.glsl.ShaderError(`${tooLong}:1: the text is longer than any shader needs: is it the right file?`);
            this.numbers.textContent = "compiling …";
            const reference = picture.unpacked ??= await loadReference(this.root.dataset.folder, picture.reference);
            const state = await this.prepare(picture, this.editor.sources), { rendering } = state, states = [state];
            if (turn === this.turn && this.compared.checked && before) states.push(await this.prepare(before, live.sources));
            if (turn !== this.turn) {
                for (const { rendering } of states) rendering.stop();
                return false;
            }
            this.renderings = states;
            this.numbers.textContent = this.isPaused ? "paused: press Go on" : "";
            this.line.hidden = states.length < 2;
            this.caption.textContent = "";
            const verdict = new live.statistics.LiveVerdict(reference, ...rendering.size), other = states[1]?.rendering;
            const isPaused = (a, b) => this.isPaused || !this.isVisible || document.hidden || b && a.busy > b.busy && b.samples < MOST_SAMPLES;  // whoever has had more time waits
            other?.render({ target: () => MOST_SAMPLES, isPaused: () => isPaused(other, rendering), shown: () => this.paint(), look: film => this.compare(film, reference) });
            return rendering.render({
                target, isPaused: () => isPaused(rendering, other), shown: () => this.paint(),
                preview: film => {
                    this.checkLoops(film, state);
                    this.times ??= { compile: state.compileTime, first: performance.now() - started };
                },
                look: film => {
                    this.checkLoops(film, state);
                    if (film.rays && film.samples === verdict.nextSamples) verdict.add(film);
                    look(film, reference, verdict);
                }
            });
        }

        // Shows what is rendered: this chapter's up to the line, then that of the chapter before.
        paint() {
            const [own, other] = this.renderings.map(({ rendering }) => rendering);
            if (!own) return;
            const [width] = own.size, end = other ? Math.round(width * this.line.value / 100) : width;
            this.renderer.show(other ? [[own, end], [other, width]] : [[own, end]], this.view.value !== "NORMALS");
            this.overlay.style.clipPath = `inset(0 ${100 * (1 - end / width)}% 0 0)`;
        }

        // What both chapters have reached in the same time. A film of the chapter before is compared with the reference, too.
        compare(film, reference) {
            const words = (chapter, samples, error) => `chapter ${parseInt(chapter)}: ${samples} samples, error ${percent(error)}`;
            const [{ chapter }, other] = this.renderings, own = this.errors.at(-1);
            if (own && film.samples > 1) this.caption.textContent = `After the same time, left ${words(chapter, ...own)}; right ${words(other.chapter, film.samples, live.statistics.relativeError(film, reference).error)}.`;
        }

        // Throws if a loop had to be ended: then the samples are wrong.
        checkLoops(film, { rendering, translated }) {
            if (!film.stuck) return;
            const { file, line } = translated.loop(film.stuck);
            rendering.stop();
            const most = Math.min(film.turns, TURNS).toLocaleString("en");
            throw new live.glsl.ShaderError(`${file}:${line}: this loop does not end, or it takes more than ${most} turns in a sample`);
        }

        async restart() {
            if (!this.activate()) return;
            const started = performance.now(), picture = this.about.pictures[this.scene.value];
            this.errors = [];
            this.film = null;
            this.drawOverlay();
            this.results.replaceChildren();
            try {
                await this.renderPicture(picture, () => MOST_SAMPLES, (...all) => this.show(...all, started));
            } catch (error) { this.report(error); }
        }

        async check() {
            if (!this.activate()) return;
            this.setPaused(false);
            this.compared.checked = false;
            this.view.value = "picture";
            this.length.value = "";
            if (this.strategy.value) this.strategy.selectedIndex = 0;
            try { await live.check(this, MOST_SAMPLES); } catch (error) { this.report(error); }
        }

        report(error) {
            if (this.renderer.gl.isContextLost()) return;  // which has been said
            this.numbers.textContent = "";
            if (error instanceof live.glsl.ShaderError) {
                this.editor.showError(error.message);
                this.fail("the shader has an error: see below the text");
            } else this.fail(error.message);
        }

        show(film, reference, verdict, started) {
            this.editor.showError("");
            Object.assign(this, { film, reference, latest: verdict, losses: film.samples < ENOUGH ? this.losses : 0 });
            const seconds = (performance.now() - started) / 1000, { means, error } = live.statistics.relativeError(film, reference);
            this.means = means;
            const hasReference = !this.isView && this.length.value === "";
            const isBiased = verdict.verdict?.isBiased;
            this.verdict.className = "live-verdict" + (!hasReference || !verdict.verdict ? "" : isBiased ? " live-biased" : " live-agrees");
            this.verdict.textContent = this.isView ? "this view shows surfaces, not light" : !hasReference ? "no verdict: there is no reference for this path length" :
                !film.rays ? "no verdict: the shader traces no ray" : verdict.text;
            if (hasReference) this.errors.push([film.samples, error]);
            this.numbers.textContent = `${film.samples} samples a pixel, ${seconds.toFixed(1)} s, ${(film.rays / seconds / 1e6).toFixed(2)} million rays per second` +
                (film.samples === 1 ? "" : hasReference ? `, error ${percent(error)}` : "") +
                (film.invalid ? `; ${film.invalid} samples are infinite or no numbers: their pixels are magenta` : "");
            this.drawPlot();
            this.drawOverlay();
        }

        // What is not the picture itself: differences, the verdict's map, noise. One pixel of the overlay is one of the reference or a tile.
        drawOverlay() {
            const { film, reference, overlay, latest } = this, view = this.view.value;
            overlay.hidden = !film || !["difference", "bias", "noise"].includes(view) || view === "bias" && !latest.verdict;
            if (overlay.hidden) return;
            const mean = reference.mean.reduce((sum, r) => sum + r, 0) / reference.mean.length;
            const paint = (width, height, value) => {
                [overlay.width, overlay.height] = [width, height];
                const image = new ImageData(width, height);
                for (let i = 0; i < width * height; ++i) image.data.set([...signedColour(value(i)), 255], 4 * i);
                overlay.getContext("2d").putImageData(image, 0, 0);
            };
            const channels = (values, i) => (values[3 * i] + values[3 * i + 1] + values[3 * i + 2]) / 3;
            if (view === "difference") paint(reference.width, reference.height, i => 2 * (channels(this.means, i) - channels(reference.mean, i)) / (channels(reference.mean, i) + 0.1 * mean));
            if (view === "noise") paint(film.width, film.height, i => Math.abs(channels(film.differences, i)) / (Math.abs(channels(film.sums, i)) + 0.1 * mean * film.samples));
            if (view === "bias") paint(...latest.tiles, i => latest.verdict.map[i] / 5);
        }

        drawPlot() {
            const points = this.errors.filter(([samples, error]) => samples >= 2 && error > 0);
            if (points.length < 2) { this.plot.replaceChildren(); return; }
            const x = samples => 34 + 21 * Math.log2(samples), largest = Math.max(...points.map(([, error]) => error));
            const y = error => 8 + 80 * Math.log(largest / error) / Math.log(largest / Math.min(...points.map(([, e]) => e), largest / 8));
            const [first, last] = [points[0], points.at(-1)];
            const line = points.map(([samples, error]) => `${x(samples).toFixed(1)},${y(error).toFixed(1)}`).join(" ");
            this.plot.innerHTML = `<svg viewBox="0 0 300 110" role="img" aria-label="error against samples: ${percent(first[1])} after ${first[0]}, ${percent(last[1])} after ${last[0]}">` +
                `<polyline points="${line}"/>` + points.map(([samples, error]) => `<circle cx="${x(samples)}" cy="${y(error)}" r="2.5"/>`).join("") +
                `<text x="2" y="${y(first[1]) + 4}">${percent(first[1])}</text><text x="2" y="${y(last[1]) + 4}">${percent(last[1])}</text>` +
                `<text x="${x(first[0])}" y="106" text-anchor="middle">${first[0]}</text><text x="${x(last[0])}" y="106" text-anchor="middle">${last[0]}</text></svg>`;
        }
    }

    function init() {
        for (const root of document.querySelectorAll("div.live")) {
            root.replaceChildren();
            if (root.dataset.chapter === "report") root.report = new live.Report(root, Frame);
            if (!(root.dataset.chapter in live.chapters)) continue;
            root.frame = new Frame(root, !root.dataset.bug);
            new IntersectionObserver(entries => { root.frame.isVisible = entries.at(-1).isIntersecting; }).observe(root);
        }
    }
    if (document.readyState === "loading") addEventListener("DOMContentLoaded", init); else init();
    return { Frame };
})();
