// The picture of a live frame: its canvases, and what renders there.
"use strict";

live.Picture = (() => {
    const {element} = live, {loadData, loadReference, unpackWords} = live.loading, {percent} = live.plot;
    const {Renderer, Rendering} = live.rendering;
    // What a reference knows of the parameters, and what the programs say where it differs: common/rendering/scene_reference.cpp.
    const DIFFERENCES = {
        max_path_length: "there is no reference for this path length",
        camera: "the camera has changed",
        background: "the background is not the scene's"
    };
    const SHOWS_SURFACES = {
        "path_trace.glsl": "shaders/observation/view.glsl",
        "sample_loop.glsl": "shaders/engine/sample_loop.glsl"
    };
    const TURNS = 65536;  // that the loops of a sample may take if paths are short, as in shaders/engine/limited_loops.glsl

    function stopAll(states) {
        for (const {rendering, denoiser} of states) {
            rendering.stop();
            denoiser?.stop();
        }
    }

    return class Picture {
        static MOST_SAMPLES = 4096;

        // Of the frame's texts, with the choices of its controls.
        constructor(frame) {
            const {chapter, root: {dataset: {folder}}} = frame;
            Object.assign(this, {frame, chapter, folder, turn: 0, losses: 0});
            this.renderings = [];  // of this chapter, and perhaps of the one before
            this.errors = [];      // samples and error, of this chapter
            this.overlay = element("canvas", {class: "live-overlay", "aria-hidden": "true"});
            this.line = element("input", {
                type: "range",
                class: "live-line",
                min: "0",
                max: "100",
                value: "50",
                hidden: "",
                "aria-label": "the line between this chapter, left, and the one before",
                input: () => this.paint()
            });
            const keys =
                "W A S D Q E and the arrow keys move the camera, F takes it back, Enter follows a path, Escape leaves it";
            const named = {role: "application", "aria-label": `the picture: ${keys}`, tabindex: "0"};
            const hint = "Drag to turn, W A S D Q E to fly, F to go back. Click a pixel for its path.";
            this.root = element("div", {class: "live-canvases", ...named}, this.overlay, this.line);
            live.Camera.listen(this.root, this);
            this.path = new live.PathPanel(this);
            this.root.append(this.path.drawing);
            this.root.addEventListener("keydown", ({key, target}) => {
                if (target !== this.root) return;
                if (key === "Enter") this.clicked(0.5, 0.5);
                if (key === "Escape") this.path.select(null);
            });
            this.hint = element("p", {class: "live-numbers"}, hint);
            this.caption = element("p", {class: "live-numbers"});
            this.numbers = element("p", {class: "live-numbers"});
        }

        // A browser gives a page few contexts, and takes the oldest away: all frames draw on one canvas, which moves to the
        // active one.
        begin() {
            if (!Picture.renderer) {
                Picture.canvas =
                    element("canvas", {width: "256", height: "256", role: "img", "aria-label": "the picture as it renders"});
                Picture.renderer = new Renderer(Picture.canvas);
                Picture.canvas.addEventListener("webglcontextlost", event => {
                    event.preventDefault();
                    Picture.active?.lost();
                });
                Picture.canvas.addEventListener("webglcontextrestored", () => {
                    Picture.renderer.make();
                    Picture.active?.restored();
                });
            }
            this.renderer = Picture.renderer;
        }

        // Makes this picture the one that renders. Returns whether the page has a device.
        activate() {
            if (!this.renderer) return false;
            if (Picture.active !== this) Picture.active?.frame.stop();
            Picture.active = this;
            this.root.prepend(Picture.canvas);
            const isLost = this.renderer.gl.isContextLost();
            if (isLost) this.frame.fail("The browser has taken the GPU away: reload the page if the picture does not come back.");
            return !isLost;
        }

        lost() {
            this.stop();
            this.frame.fail(
                ++this.losses > 1 ?
                    "The browser took the GPU away again before the picture had got far. Make the shader smaller, then press Restart." :
                    "The browser took the GPU away; starting again …");
        }

        restored() {
            if (this.losses < 2) this.frame.restart();
        }

        stop() {
            ++this.turn;
            stopAll(this.renderings);
            this.renderings = [];
        }

        // The camera has moved: what renders begins anew, without compiling.
        moved() {
            this.started = performance.now();
            this.errors = [];
            this.caption.textContent = "";
            for (const {rendering, parameters} of this.renderings) {
                parameters.set(this.camera.words);
                rendering.change(parameters);
            }
            this.frame.cameraMoved();
            this.path.update();
        }

        // At a place relative to the picture's size.
        clicked(x, y) {
            const [own] = this.renderings;
            const pixel = (part, count) => Math.min(Math.floor(part * count), count - 1);
            if (own) this.path.select([x, y].map((part, i) => pixel(part, own.rendering.size[i])));
        }

        resetCamera() {
            if (!this.camera.hasMoved) return;
            this.camera.reset();
            this.frame.restart();
        }

        // Why the picture of this chapter has no verdict; empty if it has.
        get withoutVerdict() {
            const {picture, renderings: [{parameters}], renderer: {layout}} = this;
            if (this.frame.solver?.isChanged) return "colours have been changed";
            if (!picture.reference) return "this scene has no reference";
            if (this.frame.controls.shownInstead) return `the picture shows ${this.frame.controls.shownInstead}`;
            const differs = member => {
                const place = layout.offsetOf("RenderParameters", member), type = layout.typeOf("RenderParameters", member);
                return parameters.subarray(place, place + layout.wordsOf(type))
                    .some((x, i) => x !== picture.parameters[place + i]);
            };
            return DIFFERENCES[Object.keys(DIFFERENCES).find(differs)] ?? "";
        }

        // Compiles texts for a picture's scene. Throws ShaderErrors.
        async prepare({scene, parameters: words, chapter = this.chapter, options = this.frame.controls.options}, sources) {
            if (typeof scene === "string") scene = await loadData(this.folder, scene);
            scene.words ??= await unpackWords(scene.packed);
            const parameters = Uint32Array.from(words);
            const placeOf = member => this.renderer.layout.offsetOf("RenderParameters", member);
            const size = [...parameters.subarray(placeOf("image_size"), placeOf("image_size") + 2)];
            const {isView, view, length, background} = this.frame.controls;
            if (length.value !== "")
                parameters[placeOf("max_path_length")] = Math.min(Math.max(Math.round(length.value), 0), 100);
            const defines = [...scene.defines, ...options], views = isView ? [`VIEW_${view.value}`] : [];
            if (background) parameters.set(new Uint32Array(Float32Array.from(background).buffer), placeOf("background"));
            if (background?.some(radiance => radiance > 0)) defines.push("FEATURE_SKY");
            if (this.hasLightPaths(parameters, defines, views)) defines.push("SPLATS");
            const state = {chapter, sources, scene, defines, parameters}, compiled = await this.compile(state, views);
            if (this.camera?.hasMoved) parameters.set(this.camera.words);
            return {...state, ...compiled, rendering: new Rendering(this.renderer, {...compiled, scene, parameters, size})};
        }

        // Compiles the chapter's program, or with `views`, their defines, what shows surfaces instead.
        async compile({chapter, sources, scene, defines}, views) {
            const named = views.length ? SHOWS_SURFACES : {}, hasLightPaths = defines.includes("SPLATS");
            const adder = hasLightPaths ? await this.renderer.compile(live.Splats.adder(live.sources, chapter)) : undefined;
            const translated = live.glsl.translate({sources, chapter, named, defines: [...defines, ...views], scene});
            const started = performance.now(), linked = await this.renderer.compile(translated);
            return {translated, linked, adder, compileTime: performance.now() - started};
        }

        // Whether light paths find a part of the light. Where the device cannot add it up, camera paths find all.
        hasLightPaths(parameters, defines, views) {
            const {renderer, frame: {note}} = this, unit = parameters[renderer.layout.offsetOf("RenderParameters", "splat_unit")];
            if (!unit || views.length || defines.includes("STRATEGY STRATEGY_BOUNCES")) return false;
            const lack = live.Splats.lackOf(renderer);
            if (lack) note.textContent = `This device lacks ${lack}, which light paths need: camera paths find all light.`;
            return !lack;
        }

        // Renders a picture; look(film, state, verdict) is called at powers of two. Returns whether it came to its end.
        async render(picture, target, look) {
            this.stop();
            const {turn, frame, frame: {controls, editor}} = this, {before} = picture;
            if (editor.tooLong)
                throw new live.glsl.ShaderError(
                    `${editor.tooLong}:1: the text is longer than any shader needs: is it the right file?`);
            this.numbers.textContent = "compiling …";
            this.errors = [];
            this.started = performance.now();
            const {solver} = frame, scene = await loadData(this.folder, picture.scene);
            if (turn !== this.turn) return false;
            if (this.picture?.scene !== picture.scene) this.camera = new live.Camera(picture.parameters, scene.camera);
            this.picture = picture;
            const reference = picture.unpacked ??= picture.reference ? await loadReference(this.folder, picture.reference) : null;
            const changed = {...picture, scene: await solver?.changed(scene) ?? scene};
            const state = await this.prepare(changed, editor.sources), {rendering} = state, states = [state];
            if (turn === this.turn && controls.compared.checked && before) states.push(await this.prepare(before, live.sources));
            try {
                if (controls.filter) state.denoiser = await live.Denoiser.make(this, state, controls.filter);
            } catch (error) {
                stopAll(states);
                throw error;
            }
            if (turn !== this.turn) {
                stopAll(states);
                return false;
            }
            this.renderings = states;
            this.path.update();
            this.numbers.textContent = controls.isPaused ? "paused: press Go on" : "";
            this.line.hidden = states.length < 2;
            this.caption.textContent = "";
            const verdict = reference && new live.statistics.LiveVerdict(reference, ...rendering.size);
            const other = states[1]?.rendering;
            const isPaused = (a, b) => controls.isPaused && !(this.camera.hasMoved && a.isFirstPass) || !frame.isVisible ||
                document.hidden || b && a.busy > b.busy && b.samples < Picture.MOST_SAMPLES;  // whoever has had more time waits
            other?.render({
                target: () => Picture.MOST_SAMPLES,
                isPaused: () => isPaused(other, rendering),
                shown: () => this.paint(),
                look: film => this.withoutVerdict || this.compare(film, reference)
            });
            return rendering.render({
                target,
                isPaused: () => isPaused(rendering, other),
                shown: () => this.paint(),
                preview: film => {
                    this.checkLoops(film, state);
                    this.times ??= {compile: state.compileTime, first: performance.now() - this.started};
                },
                look: async film => {
                    this.checkLoops(film, state);
                    if (!this.withoutVerdict && film.rays && film.samples === verdict.nextSamples) verdict.add(film);
                    const started = performance.now(), shown = state.denoiser ? await state.denoiser.filter(film) : film;
                    if (state.denoiser) rendering.busy += performance.now() - started;
                    if (shown) look(shown, reference, verdict);
                }
            });
        }

        // Shows what is rendered: this chapter's up to the line, then that of the chapter before.
        paint() {
            const [own, other] = this.renderings.map(({rendering}) => rendering);
            if (!own) return;
            const [width] = own.size, end = other ? Math.round(width * this.line.value / 100) : width;
            this.renderer.show(other ? [[own, end], [other, width]] : [[own, end]], this.frame.controls.view.value !== "NORMALS");
            this.overlay.style.clipPath = `inset(0 ${100 * (1 - end / width)}% 0 0)`;
        }

        // What both chapters have reached in the same time. A film of the chapter before is compared with the reference, too.
        compare(film, reference) {
            const words = (chapter, samples, error) =>
                `chapter ${parseInt(chapter)}: ${samples} samples, error ${percent(error)}`;
            const [{chapter}, other] = this.renderings, own = this.errors.at(-1);
            if (!own || film.samples <= 1) return;
            const right = words(other.chapter, film.samples, live.statistics.relativeError(film, reference).error);
            this.caption.textContent = `After the same time, left ${words(chapter, ...own)}; right ${right}.`;
        }

        // Throws if a loop had to be ended: then the samples are wrong.
        checkLoops(film, {rendering, translated}) {
            if (!film.stuck) return;
            const {file, line} = translated.loop(film.stuck);
            rendering.stop();
            const most = Math.min(film.turns, TURNS).toLocaleString("en");
            throw new live.glsl.ShaderError(
                `${file}:${line}: this loop does not end, or it takes more than ${most} turns in a sample`);
        }
    };
})();
