// Filters the pictures of a rendering with the chapter's filter.glsl: renders what else the filter needs to know, as
// common/rendering/denoiser.h does in the programs, and draws the steps of shaders/engine/filter.frag.
"use strict";

live.Denoiser = (() => {
    const {Rendering, ARRAY_WIDTH, SHORT, LONG} = live.rendering, {Film} = live;
    const FIRST = 4;             // samples of the first picture that is filtered: both halves have some before and after 2
    const FEATURE_SAMPLES = 16;  // of albedo and normals
    const MOST_TURNS = 1 << 16;  // of the loops of a pixel in a step

    return class Denoiser {
        // For what Picture.prepare() has returned. Throws a ShaderError if the filter does not compile.
        static async make(picture, state, {define, passes}) {
            const {chapter, sources} = state, {renderer} = picture, main = "shaders/engine/filter.frag";
            const translated = live.glsl.translate({sources, chapter, defines: [define], scene: {images: []}, main});
            return new Denoiser(picture, state, translated, await renderer.compile(translated), passes);
        }

        constructor(picture, state, translated, linked, passes) {
            const {renderer, renderer: {gl}} = picture, {rendering} = state;
            Object.assign(this, {picture, state, rendering, renderer, gl, translated, linked, others: []});
            this.steps = ["INPUT", "SMOOTH", ...Array(passes).fill("PASS"), "PICTURE"];
            // Two that hold pixels being filtered and take turns, and the filtered one.
            this.films = [0, 1, 2].map(() => new Film(renderer, rendering.size));
        }

        // Whether the rendering has begun anew or ended: what is under way is of no use.
        get isLate() { return this.rendering.changed || this.rendering.isStopped || this.gl.isContextLost(); }

        // The rendering has a film of 1, 2, 4, … samples. Lets it show the filtered one, and returns that, or the film itself
        // while it has too few samples. Returns nothing if the rendering has begun anew meanwhile.
        async filter(film) {
            const {before, rendering} = this;
            if (film.samples === 1) this.restart();
            if (film.samples < FIRST / 2) return film;
            this.emission ??= await this.prepare();
            this.before = {words: film.words, emission: await this.render(this.emission, film.samples)};
            if (film.samples < FIRST) return film;
            this.albedo ??= await this.render(await this.prepare("VIEW_ALBEDO", "BEHIND_GLASS"), FEATURE_SAMPLES);
            this.normals ??= await this.render(await this.prepare("VIEW_NORMALS", "BEHIND_GLASS"), FEATURE_SAMPLES);
            if (this.isLate) return undefined;
            const now = this.before, {layout: {constants}} = this.renderer, films = [];
            films[constants.FILM_NOW] = now.words;
            films[constants.FILM_BEFORE] = before.words;
            films[constants.FILM_EMISSION] = now.emission;
            films[constants.FILM_EMISSION_BEFORE] = before.emission;
            films[constants.FILM_ALBEDO] = this.albedo;
            films[constants.FILM_NORMALS] = this.normals;
            if (!await this.runSteps(films.flat())) return undefined;
            rendering.filtered = this.films[2];
            this.picture.paint();
            const {sums, differences} = rendering.read(rendering.filtered);
            return {...film, sums, differences};
        }

        // A rendering along the same camera rays that needs no bounce: of emission, or of a view, with numbers of its own.
        async prepare(...views) {
            const {picture, state, rendering: {size}, renderer: {layout}} = this;
            const parameters = state.parameters.slice(), defines = state.defines.filter(define => define !== "SPLATS");
            for (const member of ["max_path_length", "splat_unit"]) parameters[layout.offsetOf("RenderParameters", member)] = 0;
            const seed = layout.offsetOf("RenderParameters", "seed_key");
            if (views.length) parameters.set(parameters.slice(seed, seed + 2).map(word => ~word), seed);
            const compiled = await picture.compile({...state, defines}, views);
            const rendering = new Rendering(this.renderer, {...compiled, scene: state.scene, parameters, size});
            this.others.push(rendering);
            if (this.rendering.isStopped) this.stopOthers();
            return rendering;
        }

        // The words of its film with so many samples. Nothing of use if the rendering has begun anew meanwhile.
        async render(rendering, samples) {
            let words;
            const look = film => {
                words = film.words;
            };
            await rendering.render({target: () => this.isLate ? 0 : samples, look});
            return words;
        }

        // Filters films, given as lists of words. Returns whether it came to its end.
        async runSteps(lists) {
            const {gl, renderer, rendering, steps, films: [, , result]} = this, films = this.films.slice(0, 2);
            const rowsOfTexture = Math.ceil(lists.length * lists[0].length / 4 / ARRAY_WIDTH);
            const words = new Uint32Array(4 * ARRAY_WIDTH * rowsOfTexture);
            lists.forEach((list, i) => words.set(list, i * list.length));
            const texture = renderer.image(gl.RGBA32UI, ARRAY_WIDTH, rowsOfTexture, gl.RGBA_INTEGER, gl.UNSIGNED_INT, words);
            for (const [number, step] of steps.entries()) {
                const film = step === "PICTURE" ? result : films[1], [, height] = rendering.size;
                for (let row = 0, rows = 1; row < height && !this.isLate;) {
                    const started = performance.now();
                    this.setUp(texture, films[0], step, number - steps.indexOf("PASS"));
                    film.draw(row, Math.min(rows, height - row));
                    await rendering.finished();
                    row += rows;
                    const time = performance.now() - started;
                    rows = time < SHORT ? 2 * rows : time > LONG ? Math.max(1, rows >> 1) : rows;
                    if (!this.isLate && (row >= height || time > LONG)) this.checkLoops(film);
                }
                films.reverse();
            }
            gl.deleteTexture(texture);
            return !this.isLate;
        }

        // Makes the filter the current program, for a step that reads these films.
        setUp(texture, film, step, pass) {
            const {gl, renderer, renderer: {layout: {constants}}, linked, linked: {place}} = this;
            gl.useProgram(linked.program);
            film.bind(linked);
            renderer.bind(linked, "web_arrays", Film.COUNT, texture);
            gl.uniform2ui(place("filtering.image_size"), ...this.rendering.size);
            gl.uniform1ui(place("filtering.step"), constants[`FILTER_STEP_${step}`]);
            gl.uniform1ui(place("filtering.pass"), Math.max(pass, 0));
            gl.uniform1ui(place("web_most_turns"), MOST_TURNS);
        }

        // Throws if a loop had to be ended: then a pixel's last word has the first bit and the place. Other such words are
        // numbers below 0.
        checkLoops(film) {
            const words = film.readWords().at(-1), isLast = (_, i) => i % 4 === 3;
            const stuck = words.filter(isLast).find(word => word >>> 31 && this.translated.loop(word & 0x7fffffff));
            if (!stuck) return;
            const {file, line} = this.translated.loop(stuck & 0x7fffffff), most = MOST_TURNS.toLocaleString("en");
            this.rendering.stop();
            throw new live.glsl.ShaderError(
                `${file}:${line}: this loop does not end, or it takes more than ${most} turns in a pixel`);
        }

        restart() {
            this.stopOthers();
            Object.assign(this, {emission: undefined, albedo: undefined, normals: undefined, before: undefined});
        }

        stopOthers() {
            for (const rendering of this.others.splice(0)) rendering.stop();
        }

        // Ends what is under way, when the rendering has ended.
        stop() {
            this.stopOthers();
            for (const film of this.films.splice(0)) film.delete();
        }
    };
})();
