// A film: three textures of 32-bit words, twelve words a pixel, and a fourth where light paths add light (see splats.js).
"use strict";

live.Film = (() => {
    const COUNT = 3;
    // How many textures a draw writes: some devices write fewer bits at once, and draw everything twice.
    const MOST_WRITTEN = [4, 2, 1];

    return class Film {
        // The number of textures without that of light paths, which is also the place of that one.
        static COUNT = COUNT;

        constructor(renderer, size, hasLightPaths) {
            const {gl} = renderer;
            Object.assign(this, {renderer, gl, size});
            const image = () => renderer.image(gl.RGBA32UI, ...size, gl.RGBA_INTEGER, gl.UNSIGNED_INT, null);
            this.textures = Array.from({length: hasLightPaths ? COUNT + 1 : COUNT}, image);
            const all = [...this.textures.keys()];
            for (const most of MOST_WRITTEN) {
                const passes = all.filter(i => i % most === 0).map(i => all.slice(i, i + most));
                this.frames = passes.map(written => this.makeFrame(written));
                if (this.frames.every(({isComplete}) => isComplete)) return;
                this.deleteFrames();
            }
            throw new Error("this device cannot store the sums of a picture: try another browser");
        }

        // What a draw writes these textures through.
        makeFrame(written) {
            const {gl, textures} = this, frame = gl.createFramebuffer();
            gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
            for (const i of written)
                gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, textures[i], 0);
            const isComplete = gl.isContextLost() || gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE;
            const targets = textures.slice(0, written.at(-1) + 1);
            gl.drawBuffers(targets.map((_, i) => written.includes(i) ? gl.COLOR_ATTACHMENT0 + i : gl.NONE));
            if (isComplete) this.clearFrame({frame, written});
            return {frame, written, isComplete};
        }

        clearFrame({frame, written}) {
            const {gl} = this;
            gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
            gl.disable(gl.SCISSOR_TEST);
            for (const i of written) gl.clearBufferuiv(gl.COLOR, i, [0, 0, 0, 0]);
        }

        clear() {
            for (const frame of this.frames) this.clearFrame(frame);
        }

        // Lets a program read this film.
        bind(linked) {
            for (let i = 0; i < COUNT; ++i) this.renderer.bind(linked, `web_film_before[${i}]`, i, this.textures[i]);
        }

        // Lets the current program write some rows of this film.
        draw(row, rows) {
            const {gl, size} = this;
            gl.viewport(0, 0, ...size);
            gl.enable(gl.SCISSOR_TEST);
            gl.scissor(0, row, size[0], rows);
            for (const {frame} of this.frames) {
                gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
                gl.drawArrays(gl.TRIANGLES, 0, 3);
            }
        }

        // The words, three lists of four a pixel.
        readWords() {
            const {gl, size: [width, height]} = this;
            return this.textures.slice(0, COUNT).map((_, i) => {
                const words = new Uint32Array(4 * width * height);
                gl.bindFramebuffer(gl.FRAMEBUFFER, this.frames.find(({written}) => written.includes(i)).frame);
                gl.readBuffer(gl.COLOR_ATTACHMENT0 + i);
                gl.readPixels(0, 0, width, height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, words);
                return words;
            });
        }

        deleteFrames() {
            for (const {frame} of this.frames) this.gl.deleteFramebuffer(frame);
        }

        delete() {
            for (const texture of this.textures) this.gl.deleteTexture(texture);
            this.deleteFrames();
        }
    };
})();
