// Renders a scene with WebGL 2: a texture of 32-bit words holds its arrays, and a film (film.js) the sums of samples.
"use strict";

live.rendering = (() => {
    const ARRAY_WIDTH = 2048;     // texels of the arrays' textures, which every device allows
    const MOST_PROGRAMS = 16;     // that are kept
    const SHORT = 20, LONG = 80;  // milliseconds of a draw call: the page has to answer meanwhile
    // Turns that the loops of a sample may take at first, by how much this grows, and milliseconds of a draw that some systems do
    // not bear.
    const FEW_TURNS = 1 << 13, MORE = 16, MOST_TURNS = 0xffffffff, TOO_LONG = 4000;
    const FULL_SCREEN = `#version 300 es
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }`;
    const DISPLAY = `#version 300 es
precision highp float;
precision highp int;
uniform highp usampler2D web_film_before[3];
uniform bool is_srgb;
out vec4 colour;
void main() {
    ivec2 size = textureSize(web_film_before[0], 0), place = ivec2(gl_FragCoord.x, float(size.y) - gl_FragCoord.y);
    if (texelFetch(web_film_before[2], place, 0).y == 0u) place = (place & ~7) | (place & 1);  // a preview has rendered these pixels
    uvec4 a = texelFetch(web_film_before[0], place, 0), b = texelFetch(web_film_before[1], place, 0), c = texelFetch(web_film_before[2], place, 0);
    vec3 mean = (uintBitsToFloat(a.xyz) + uintBitsToFloat(uvec3(a.w, b.xy))) / float(max(c.y, 1u));
    float sum = mean.r + mean.g + mean.b;  // derivatives may be negative: such pixels are blue
    vec3 shown = clamp(sum < 0.0 ? vec3(0.0, 0.0, -sum / 3.0) : mean, 0.0, 1.0);
    vec3 curved = mix(12.92 * shown, 1.055 * pow(shown, vec3(1.0 / 2.4)) - 0.055, greaterThan(shown, vec3(0.0031308)));
    colour = vec4(c.z > 0u ? vec3(1.0, 0.0, 1.0) : is_srgb ? curved : shown, 1.0);
}`;

    const pause = milliseconds => new Promise(resolve => setTimeout(resolve, milliseconds));

    // The device: what all pictures of a page share.
    class Renderer {
        // Throws an Error that says what the reader can do.
        constructor(canvas) {
            if (!globalThis.DecompressionStream) throw new Error("this browser is too old: update it");
            const wishes = {antialias: false, alpha: false, preserveDrawingBuffer: true, powerPreference: "high-performance"};
            this.gl = canvas.getContext("webgl2", wishes);
            if (!this.gl)
                throw new Error("this browser offers no WebGL 2: update it, or switch graphics acceleration on in its settings");
            this.layout = new live.Layout(live.sources["shaders/interface.h"]);
            this.make();
        }

        // What has to be made again after the browser has taken the context away.
        make() {
            this.parallel = this.gl.getExtension("KHR_parallel_shader_compile");
            this.display = this.link(FULL_SCREEN, DISPLAY);
            this.compiled = new Map();  // the last programs by their text, the oldest first
        }

        // The name of the device, and whether a program draws in place of one.
        get device() {
            const info = this.gl.getExtension("WEBGL_debug_renderer_info");
            const name = String(this.gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : this.gl.RENDERER));
            return {name, isSlow: /swiftshader|llvmpipe|softpipe|basic render|software/i.test(name)};
        }

        // A program, and the place of a uniform.
        link(vertex, fragment) {
            const {gl} = this, program = gl.createProgram(), places = {};
            for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
                const shader = gl.createShader(kind);
                gl.shaderSource(shader, text);
                gl.compileShader(shader);
                gl.attachShader(program, shader);
            }
            gl.linkProgram(program);
            return {program, place: name => places[name] ??= gl.getUniformLocation(program, name)};
        }

        // Compiles a translated shader, or returns one of the last. Throws a ShaderError with the place in the reader's files.
        async compile(translated) {
            const {gl, parallel, compiled} = this;
            const linked = compiled.get(translated.text) ?? this.link(FULL_SCREEN, translated.text), {program} = linked;
            compiled.delete(translated.text);
            while (parallel && !gl.isContextLost() && !gl.getProgramParameter(program, parallel.COMPLETION_STATUS_KHR))
                await pause(5);
            if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
                const logs = gl.getAttachedShaders(program).map(shader => gl.getShaderInfoLog(shader) ?? "");
                gl.deleteProgram(program);
                const log = logs.find(text => text.trim()) ?? gl.getProgramInfoLog(program) ?? "";
                throw new live.glsl.ShaderError(live.glsl.readableError(log, translated));
            }
            compiled.set(translated.text, linked);
            if (compiled.size > MOST_PROGRAMS) {
                const [[oldest, {program}]] = compiled;
                compiled.delete(oldest);
                gl.deleteProgram(program);
            }
            return linked;
        }

        image(format, width, height, layout, type, data) {
            const {gl} = this, texture = gl.createTexture();
            gl.activeTexture(gl.TEXTURE0);
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, layout, type, data);
            for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
            return texture;
        }

        // Sets the texture of a uniform.
        bind({place}, name, unit, texture) {
            const {gl} = this;
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.uniform1i(place(name), unit);
        }

        // Shows pictures of one size side by side: each up to the `end` of its part, in pixels.
        show(parts, isSrgb) {
            const {gl, display} = this, [[{size}]] = parts;
            if (gl.isContextLost()) return;
            if (gl.canvas.width !== size[0] || gl.canvas.height !== size[1]) [gl.canvas.width, gl.canvas.height] = size;
            gl.useProgram(display.program);
            gl.uniform1i(display.place("is_srgb"), isSrgb ? 1 : 0);
            gl.bindFramebuffer(gl.FRAMEBUFFER, null);
            gl.viewport(0, 0, ...size);
            gl.enable(gl.SCISSOR_TEST);
            let start = 0;
            for (const [picture, end] of parts) {
                (picture.filtered ?? picture.films[picture.isFirstPass ? 1 : 0]).bind(display);
                gl.scissor(start, 0, end - start, size[1]);
                gl.drawArrays(gl.TRIANGLES, 0, 3);
                start = end;
            }
        }
    }

    // A picture of a scene with a compiled program.
    class Rendering {
        constructor(renderer, {translated: {hasSampleLoop}, linked, adder, scene, parameters, size}) {
            const {gl, layout} = renderer;
            Object.assign(this, {renderer, gl, linked, size, samples: 0, turns: FEW_TURNS});
            this.splats = adder && new live.Splats(renderer, size, adder);
            this.rendersMany = hasSampleLoop && !adder;  // samples in a draw: a fragment keeps one connection
            Object.assign(this, {busy: 0, isFirstPass: true, isStopped: false});  // `busy`: milliseconds of draws
            this.filtered = null;  // the film that a Denoiser has made of this picture
            const {words} = scene, height = Math.ceil(words.length / 4 / ARRAY_WIDTH);
            const texels = new Uint32Array(4 * ARRAY_WIDTH * height);
            texels.set(words);
            // The tree is read by four words. Compilers for Direct3D take twice as long where a single word is picked out of
            // four.
            this.arrays = renderer.image(gl.RGBA32UI, ARRAY_WIDTH, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, texels);
            this.words = renderer.image(gl.R32UI, ARRAY_WIDTH, 4 * height, gl.RED_INTEGER, gl.UNSIGNED_INT, texels);
            const probe = scene.images.find(image => image.binding === layout.constants.BINDING_LIGHT_PROBE);
            if (probe) {
                const floats = new Float32Array(words.buffer, 4 * probe.first, probe.count);
                this.probe = renderer.image(gl.RGBA32F, probe.width, probe.height, gl.RGBA, gl.FLOAT, floats);
            }
            // Two films take turns, since a shader cannot write what it reads.
            this.films = [0, 1].map(() => new live.Film(renderer, size, Boolean(adder)));
            this.parameters = parameters.slice();
            gl.useProgram(linked.program);
            for (const {binding, first, count} of scene.buffers)
                gl.uniform2ui(linked.place(`web_places[${binding}]`), first, count);
        }

        // Lets render() begin anew with other parameters. What it draws at first is shown before, so that a moving camera sees
        // something.
        change(parameters) { this.changed = parameters; }

        // Ends render() at its next draw.
        stop() {
            const {gl, films, arrays, words, probe} = this;
            if (this.isStopped) return;
            this.isStopped = true;
            for (const texture of [arrays, words, probe]) gl.deleteTexture(texture ?? null);
            for (const film of films) film.delete();
            this.splats?.delete();
        }

        // Sets the members of a uniform struct from words. Returns the words behind it.
        setStruct(type, name, words) {
            const {gl, linked, renderer: {layout}} = this, place = linked.place(name), numbers = words.slice(0, 4);
            const floats = new Float32Array(numbers.buffer);
            switch (type) {
                case "float":
                    gl.uniform1f(place, floats[0]);
                    break;
                case "vec3":
                    gl.uniform3fv(place, floats.subarray(0, 3));
                    break;
                case "int":
                    gl.uniform1i(place, numbers[0] | 0);
                    break;
                case "uint":
                    gl.uniform1ui(place, numbers[0]);
                    break;
                case "uvec2":
                    gl.uniform2uiv(place, numbers.subarray(0, 2));
                    break;
                default:
                    for (const [t, member] of layout.structs[type]) words = this.setStruct(t, `${name}.${member}`, words);
                    return words;
            }
            return words.subarray(layout.wordsOf(type));
        }

        // A film: sums of samples, the differences of their halves, the number of rays, of invalid samples, and the place of a
        // stuck loop. Throws if there is no sample at all: a black picture is no evidence.
        read(source = this.films[0]) {
            const {gl, size: [width, height]} = this, count = width * height, [a, b, c] = source.readWords();
            const film = {
                width,
                height,
                samples: this.samples,
                words: [a, b, c],
                sums: new Float64Array(3 * count),
                differences: new Float64Array(3 * count),
                rays: 0,
                invalid: 0,
                stuck: 0,
                turns: this.turns
            };
            const [x, y, z] = [a, b, c].map(words => new Float32Array(words.buffer));
            let isDrawn = gl.isContextLost();
            for (let p = 0; p < count; ++p) {
                const i = 4 * p, j = 3 * p;
                film.sums.set([x[i] + x[i + 3], x[i + 1] + y[i], x[i + 2] + y[i + 1]], j);
                film.differences.set([y[i + 2], y[i + 3], z[i]], j);
                isDrawn ||= c[i + 1] > 0;
                film.invalid += c[i + 2];
                if (c[i + 3] >>> 31)
                    film.stuck = c[i + 3] & 0x7fffffff;
                else
                    film.rays += c[i + 3];
            }
            if (isDrawn || film.stuck) return film;
            const what = "either the shader finishes no sample, or this device cannot draw it; then please tell us";
            throw new Error(`nothing is drawn: ${what}`);
        }

        // Renders until `target()` samples are reached or stop() is called. Calls `look(film)` at 1, 2, 4, … samples and the
        // target, waits for it, and calls before `preview(film)`, where few pixels have a sample; `isPaused()` is asked before
        // each draw. Returns whether it was not stopped. `pace`: how much fits into a draw, from the last picture if it was like
        // this one.
        async render({target, isPaused = () => false, preview = () => {}, look, shown = () => {}}, pace = {rows: 8, step: 1}) {
            const {gl, size} = this;
            let {rows, step} = pace, isPreview = true, isChange = false;
            while (this.samples < target()) {
                if (this.changed) {
                    this.parameters = this.changed.slice();
                    this.changed = undefined;
                    this.clearFilms();
                    isPreview = isChange = true;
                }
                const look_at = 2 ** Math.floor(Math.log2(Math.max(this.samples, 0.5)) + 1);
                const next = Math.min(this.samples + (isPreview || rows < size[1] ? 1 : step), look_at, target());
                for (let row = 0; row < size[1] && (isPreview || !this.changed);) {
                    while (!this.isStopped && !this.changed && isPaused()) await pause(10);
                    if (this.isStopped || gl.isContextLost()) return false;
                    const started = performance.now();
                    for (let end = this.rendersMany ? next : this.samples + 1;; ++end) {
                        this.draw(row, Math.min(rows, size[1] - row), end, isPreview);
                        if (end >= next) break;
                        this.turnFilms(isPreview);  // one draw has rendered all rows
                    }
                    await this.finished();
                    if (this.isStopped || gl.isContextLost()) return false;
                    row += rows;
                    const time = performance.now() - started;
                    if (isPreview && time > LONG) {
                        const film = this.read(this.films[1]);
                        if (film.stuck && await this.allowMore(rows)) {
                            row = 0;
                            continue;
                        }
                        preview(film);
                    }
                    if (!isPreview) this.busy += time;  // which may include a driver's compiler
                    if (time < SHORT && rows < size[1])
                        rows *= 2;
                    else if (time < SHORT && row >= size[1])
                        step *= 2;
                    else if (time > LONG && step > 1 && rows >= size[1])
                        step = Math.ceil(step / 2);
                    else if (time > LONG)
                        rows = Math.max(1, Math.floor(rows / 2));
                    Object.assign(pace, {rows, step});
                    if (this.isFirstPass && !isChange) shown();  // the picture before stays until then
                }
                if (!isPreview && this.changed) continue;
                this.turnFilms(isPreview);
                this.isFirstPass = false;
                shown();
                if (!isPreview) this.samples = next;
                const film = isPreview || next === look_at || next >= target() ? this.read() : null;
                if (gl.isContextLost()) return false;  // what has been read is black
                if (film?.stuck && await this.allowMore(rows))
                    isPreview = true;
                else if (isPreview) {
                    isPreview = isChange = false;
                    preview(film);
                    rows = Math.max(1, rows >> 3);
                } else if (film) {
                    await look(film);
                    if (this.isStopped) return false;
                }
            }
            return true;
        }

        // A loop has been ended: lets loops take more turns and begins anew, unless a draw would keep the device busy for too
        // long. Returns whether it does. The first draw may have waited for a driver's compiler, so that its time says nothing.
        async allowMore(rows) {
            const started = performance.now(), {gl} = this;
            this.draw(0, rows, this.samples + 1, true);
            await this.finished();
            if (this.turns >= MOST_TURNS || (performance.now() - started) * MORE > TOO_LONG) return false;
            this.turns = Math.min(this.turns * MORE, MOST_TURNS);
            this.clearFilms();
            return true;
        }

        // What has been drawn is now the film. What light paths send waits until all pixels have the sample.
        turnFilms(isPreview) {
            const {films, splats} = this;
            films.reverse();
            splats?.collect(films[0]);
            if (!splats || isPreview) return;
            splats.add(...films);
            films.reverse();
        }

        clearFilms() {
            for (const film of this.films) film.clear();
            this.splats?.clear();
            Object.assign(this, {samples: 0, isFirstPass: true, filtered: null});
        }

        draw(row, rows, target, isPreview) {
            const {gl, linked, linked: {place}, films, samples} = this;
            gl.useProgram(linked.program);
            this.setStruct("RenderParameters", "parameters", this.parameters);  // since a program may draw other pictures, too
            films[0].bind(linked);
            this.renderer.bind(linked, "web_arrays", 3, this.arrays);
            this.renderer.bind(linked, "web_words", 4, this.words);
            this.renderer.bind(linked, "light_probe", 5, this.probe ?? null);
            gl.uniform1ui(place("web_target_samples"), target);
            gl.uniform1ui(place("web_samples_per_pixel"), this.rendersMany ? target - samples : 1);
            gl.uniform1i(place("web_is_preview"), isPreview ? 1 : 0);
            gl.uniform1ui(place("web_most_turns"), this.turns);
            films[1].draw(row, rows);
        }

        // Waits until the device has done everything so far.
        async finished() {
            const {gl} = this, fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
            gl.flush();
            while (fence && !gl.isContextLost() && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) await pause(0);
            gl.deleteSync(fence);
        }
    }

    return {Renderer, Rendering, ARRAY_WIDTH, SHORT, LONG, pause};
})();
