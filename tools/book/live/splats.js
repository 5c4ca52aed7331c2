// Light that light paths send to other pixels than their own. A draw cannot add to those: each fragment keeps a connection in the
// film's last texture. Points add them up, blended, and shaders/engine/add_splats.frag adds the sums to the film.
"use strict";

live.Splats = (() => {
    const NEEDED = ["EXT_color_buffer_float", "EXT_float_blend"], {COUNT} = live.Film;
    const POINT = `#version 300 es
precision highp float;
precision highp int;
uniform highp usampler2D connections;
flat out vec3 radiance;
void main() {
    ivec2 size = textureSize(connections, 0);
    uvec4 words = texelFetch(connections, ivec2(gl_VertexID % size.x, gl_VertexID / size.x), 0);
    vec2 place = (vec2(int(words.x) % size.x, int(words.x) / size.x) + 0.5) / vec2(size);
    radiance = uintBitsToFloat(words.yzw);
    gl_PointSize = 1.0;
    gl_Position = words.yzw == uvec3(0u) ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(2.0 * place - 1.0, 0.0, 1.0);
}`;
    const COLOUR = `#version 300 es
precision highp float;
flat in vec3 radiance;
out vec4 colour;
void main() { colour = vec4(radiance, 0.0); }`;

    return class Splats {
        // What a device lacks; empty if it can add up light in 32 bits.
        static lackOf({gl}) { return NEEDED.filter(name => !gl.getExtension(name)).join(" and "); }

        // The program that adds sums to films.
        static adder(sources, chapter) {
            return live.glsl.translate(
                {sources, chapter, defines: [], scene: {images: []}, main: "shaders/engine/add_splats.frag"});
        }

        // For films of this size, with the compiled adder.
        constructor(renderer, size, adder) {
            const {gl} = renderer;
            Object.assign(this, {renderer, gl, size, adder, points: renderer.link(POINT, COLOUR)});
            this.sums = renderer.image(gl.RGBA32F, ...size, gl.RGBA, gl.FLOAT, null);
            this.frame = gl.createFramebuffer();
            gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
            gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.sums, 0);
            this.clear();
        }

        clear() {
            const {gl} = this;
            gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
            gl.disable(gl.SCISSOR_TEST);
            gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
        }

        // Adds up the connections of a film.
        collect({textures}) {
            const {gl, renderer, points, size: [width, height]} = this;
            gl.useProgram(points.program);
            renderer.bind(points, "connections", 0, textures[COUNT]);
            gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
            gl.viewport(0, 0, width, height);
            gl.disable(gl.SCISSOR_TEST);
            gl.enable(gl.BLEND);
            gl.blendFunc(gl.ONE, gl.ONE);
            gl.drawArrays(gl.POINTS, 0, width * height);
            gl.disable(gl.BLEND);
        }

        // Writes a film with all that has been collected to another.
        add(film, other) {
            const {gl, renderer, adder, size: [, height]} = this;
            gl.useProgram(adder.program);
            film.bind(adder);
            renderer.bind(adder, "web_splats", COUNT, this.sums);
            other.draw(0, height);
            this.clear();
        }

        delete() {
            const {gl, sums, frame, points} = this;
            gl.deleteTexture(sums);
            gl.deleteFramebuffer(frame);
            gl.deleteProgram(points.program);
        }
    };
})();
