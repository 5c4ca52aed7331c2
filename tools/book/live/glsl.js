// Translates the project's shaders, GLSL 4.60 with Vulkan's buffers, to GLSL ES 3.00 for WebGL 2. Each line of the result belongs
// to one of a file.
"use strict";

live.glsl = (() => {
    const {Preprocessor, ShaderError, fail} = live.preprocessor, {Layout, Translation} = live;
    // What compilers say, and what helps; the first that fits.
    const ERROR_HINTS = [
        [/'path_trace' : no matching/, "the shader has to define vec3 path_trace(Ray ray, inout uvec2 seed)"],
        [/arrays of arrays/, "browsers have none: write float a[6] and a[3 * i + j] instead of float a[2][3] and a[i][j]"],
        [/'%' : wrong operand/, "% is for integers: mod(x, y) is for others"],
        [
            /dimension mismatch|not matching type/,
            "one number cannot stand for three, nor three for one: vec3(x) makes three of one, and v.x takes one of three"
        ],
        [
            /wrong operand types|cannot convert|no operation/,
            "both sides need the same type: 2.0 * x instead of 2 * x, float(i) for an integer i"
        ],
        [/'\{' : syntax error/, "is a semicolon missing before? An array's values are float[2](1.0, 2.0)"],
        [/syntax error|unexpected/, "is a semicolon or a bracket missing here or before?"],
        [/undeclared identifier|no matching overloaded function/, "is the name right, and do the types of the arguments fit?"],
        [/l-value required/, "what is const cannot be assigned"],
        [/built-in function|reserved word/, "the language of browsers keeps this name for itself: choose another"]
    ];

    const MACROS = [
        "precise", "atomicAdd(place, value) (place += (value))", "nonuniformEXT(index) (index)", "BVH_IN_STORAGE_BUFFERS",
        "__VERSION__ 460", "VULKAN 100"
    ];

    // Everything that the ES language lacks, and accessors of the textures that hold the scene's arrays.
    const PRELUDE = `
uniform highp usampler2D web_words;   // of the scene's arrays, one a texel
uniform highp usampler2D web_arrays;  // the same, four a texel
uniform uvec2 web_places[32];  // of a binding: the first word and the number of words
uvec4 web_texel(int i) { return texelFetch(web_arrays, ivec2(i & 2047, i >> 11), 0); }
uint web_pick(uvec4 v, int i) { v *= uvec4(equal(ivec4(i), ivec4(0, 1, 2, 3))); return v.x | v.y | v.z | v.w; }
float web_pick(vec3 v, int i) { return mix(mix(v.x, v.y, i == 1), v.z, i == 2); }
uint web_word(uint i) { return texelFetch(web_words, ivec2(i & 2047u, i >> 11u), 0).x; }
float web_float(uint i) { return uintBitsToFloat(web_word(i)); }
float web_fma(float a, float b, float c) { return a * b + c; }
vec3 web_fma(vec3 a, vec3 b, vec3 c) { return a * b + c; }
uvec4 web_mix(uvec4 a, uvec4 b, bvec4 c) { uvec4 m = uvec4(c); return b * m + a * (1u - m); }
void web_umulExtended(uint a, uint b, out uint high, out uint low) {
    uint a_0 = a & 65535u, a_1 = a >> 16u, b_0 = b & 65535u, b_1 = b >> 16u;
    uint middle = a_1 * b_0 + (a_0 * b_0 >> 16u), other = a_0 * b_1 + (middle & 65535u);
    high = a_1 * b_1 + (middle >> 16u) + (other >> 16u);
    low = a * b;
}
uint web_uaddCarry(uint a, uint b, out uint carry) { uint sum = a + b; carry = sum < a ? 1u : 0u; return sum; }
uint web_bitfieldReverse(uint v) {
    v = (v >> 1u & 0x55555555u) | (v & 0x55555555u) << 1u;
    v = (v >> 2u & 0x33333333u) | (v & 0x33333333u) << 2u;
    v = (v >> 4u & 0x0f0f0f0fu) | (v & 0x0f0f0f0fu) << 4u;
    v = (v >> 8u & 0x00ff00ffu) | (v & 0x00ff00ffu) << 8u;
    return v >> 16u | v << 16u;
}
uvec2 web_bitfieldReverse(uvec2 v) { return uvec2(web_bitfieldReverse(v.x), web_bitfieldReverse(v.y)); }
int web_findMSB(uint v) { int i = -1; for (; v != 0u && i < 32; v >>= 1u) ++i; return i; }
int web_findLSB(uint v) { return web_findMSB(v & (~v + 1u)); }
int web_bitCount(uint v) { int n = 0; for (int i = 0; i < 32; ++i) n += int(v >> uint(i) & 1u); return n; }
`;

    // Throws if a brace is not closed, or closes nothing.
    function checkBraces(tokens) {
        const open = [];
        for (const token of tokens) {
            if (token.text === "{") open.push(token);
            if (token.text === "}" && !open.pop())
                fail(token, "this } closes nothing: is there one too many, or a { missing before?");
        }
        if (open.length) fail(open[0], "this { is never closed: a } is missing below");
    }

    // The tables of the textures, and the function that reads their texels from the scene's words.
    function readerOf(textures) {
        if (!textures.length) return "";
        const table = (name, numbers) => `const int ${name}[${numbers.length}] = int[](${numbers.join(", ")}); `;
        const widths = table("web_texture_widths", textures.map(({width}) => width));
        const firsts = table("web_texture_firsts", textures.map(({first}) => first));
        return widths + firsts + "vec4 web_texture(int i, ivec2 p, int level) { " +
            "uint w = web_word(uint(web_texture_firsts[i] + p.y * web_texture_widths[i] + p.x)); " +
            "return vec4(w & 255u, w >> 8u & 255u, w >> 16u & 255u, w >> 24u) / 255.0; }";
    }

    // Tokens as lines, each of one place.
    function written(tokens) {
        const lines = [], places = [];
        for (const {text, place} of tokens) {
            const last = places.at(-1);
            if (last?.file === place.file && last.line === place.line)
                lines.at(-1).push(text);
            else {
                lines.push([text]);
                places.push(place);
            }
        }
        return {text: lines.map(words => `${words.join(" ")}\n`).join(""), places};
    }

    // What records a path of a chapter in place of its program, for translate().
    const recorderOf = (sources, chapter) => ({
        main: "shaders/observation/record_path.frag",
        named: {
            "path_trace.glsl": "shaders/observation/record_path/path_trace.glsl",
            "observed.glsl": `chapters/${chapter}/path_trace.glsl`,
            "sample_loop.glsl": "shaders/observation/record_path/sample_loop.glsl",
            "observed_sample_loop.glsl": finder(sources, chapter)("sample_loop.glsl", "")
        }
    });

    // Translates a chapter's program. `scene`: images as dump_arrays writes them; `named`: as finder() takes them.
    // Returns the text, functions from its line numbers and from numbers of loops to places, those of functions, and whether the
    // chapter has a sample loop of its own, which renders several samples in a draw.
    function translate({sources, chapter, named, defines, scene, main = "shaders/engine/render.frag"}) {
        const layout = new Layout(sources["shaders/interface.h"]);
        const preprocessor = new Preprocessor(sources, finder(sources, chapter, named), [...MACROS, ...defines]);
        const tokens = preprocessor.run(main);
        checkBraces(tokens);
        const textures = scene.images.filter(image => image.binding === layout.constants.BINDING_TEXTURES);
        const translation = new Translation(tokens, layout, readerOf(textures));
        translation.run();
        const {text, places} = written(translation.result);
        const head = "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp usampler2D;\n" + PRELUDE;
        const headLines = head.split("\n").length - 1;
        const hasSampleLoop = [...preprocessor.files].some(file => /^chapters\/.*\/sample_loop.glsl$/.test(file));
        const {functions, loops} = translation;
        return {
            text: head + text,
            place: line => places[line - headLines - 1],
            loop: number => loops[number - 1],
            functions,
            hasSampleLoop
        };
    }

    // A compiler's message about a translated shader as "file:line: message (hint)", the first error only.
    function readableError(log, {place, functions}) {
        const [, caller, other] = /Recursive function call in the following call chain: (\w+)(?: <- (\w+))?/.exec(log) ?? [];
        const at = ({file, line} = {}) => file ? `${file}:${line}: ` : "", way = other ? ` by way of ${other}()` : "";
        if (caller) return `${at(functions.get(caller))}${caller}() calls itself${way}: GLSL has no recursion, write a loop`;
        const [, line, text] = /^ERROR: [^:\n]*:(\d+): (.*)$/m.exec(log) ?? [];
        if (!text) return log.trim() || "the driver refuses the shader and does not say why";
        const hint = ERROR_HINTS.find(([pattern]) => pattern.test(text))?.[1];
        return `${at(place(Number(line)))}${text.trim()}${hint ? ` (${hint})` : ""}`;
    }

    // Where a shader's #include finds a file, as the programs do: those that chapters may replace in the chapter's folder, or in
    // that of the chapter which this one continues, and so on, or in shaders/.
    function finder(sources, chapter, named = {}) {
        const files = new Map([["path_trace.glsl", `chapters/${chapter}/path_trace.glsl`]]), folders = [];
        const continued = JSON.parse(sources["chapters/continued.json"]);
        for (let each = chapter; each; each = continued[each]) folders.push(`chapters/${each}/`);
        for (const path of JSON.parse(sources["shaders/replaceable.json"])) {
            const name = path.replace(/.*\//, "");
            const place = [...folders.map(folder => folder + name), `shaders/${path}`].find(place => place in sources);
            if (place) files.set(name, place);
        }
        for (const [name, path] of Object.entries(named)) files.set(name, path);
        return (name, includer) => {
            if (files.has(name)) return files.get(name);
            const places = [includer.replace(/[^/]*$/, ""), "shaders/", "chapters/"];
            return places.map(folder => new URL(folder + name, "file:///").pathname.slice(1)).find(path => path in sources);
        };
    }

    return {translate, recorderOf, finder, readableError, ShaderError};
})();
