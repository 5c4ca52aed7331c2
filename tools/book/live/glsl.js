// Translates the project's shaders, GLSL 4.60 with Vulkan's buffers, to GLSL ES 3.00 for WebGL 2. Lines stay lines, so that each
// line of the result belongs to one of a file.
"use strict";
var live = globalThis.live ?? {};
globalThis.live = live;

live.glsl = (() => {
    // The words of a scalar, vector or matrix, and nothing for other types.
    function plainWords(type) {
        const [, , rows, columns, rowsOfMatrix] = /^(float|u?int|[iu]?vec(\d)|mat(\d)(?:x(\d))?)$/.exec(type) ?? [];
        return rows ? Number(rows) : columns ? columns * (rowsOfMatrix ?? columns) : /^(float|u?int)$/.test(type) ? 1 : undefined;
    }
    const ERROR_HINTS = [
        [/wrong operand types|cannot convert|no operation/, "both sides need the same type: 2.0 * x instead of 2 * x, float(i) for an integer i"],
        [/syntax error|unexpected/, "is a semicolon or a bracket missing here or before?"],
        [/undeclared identifier|no matching overloaded function/, "is the name right, and do the types of the arguments fit?"]];

    // Everything that the ES language lacks, and accessors of the textures that hold the scene's arrays.
    const PRELUDE = `
#define precise
#define atomicAdd(place, value) (place += (value))
#define nonuniformEXT(index) (index)
uniform highp usampler2D web_words;   // of the scene's arrays, one a texel
uniform highp usampler2D web_arrays;  // the same, four a texel
uniform uvec2 web_places[32];  // of a binding: the first word and the number of words
uvec4 web_texel(int i) { return texelFetch(web_arrays, ivec2(i & 2047, i >> 11), 0); }
uint web_pick(uvec4 v, int i) { v *= uvec4(equal(ivec4(i), ivec4(0, 1, 2, 3))); return v.x | v.y | v.z | v.w; }
float web_pick(vec3 v, int i) { return mix(mix(v.x, v.y, i == 1), v.z, i == 2); }
uint web_word(uint i) { return texelFetch(web_words, ivec2(i & 2047u, i >> 11u), 0).x; }
float web_float(uint i) { return uintBitsToFloat(web_word(i)); }
float fma(float a, float b, float c) { return a * b + c; }
vec3 fma(vec3 a, vec3 b, vec3 c) { return a * b + c; }
uvec4 web_mix(uvec4 a, uvec4 b, bvec4 c) { uvec4 m = uvec4(c); return b * m + a * (1u - m); }
void umulExtended(uint a, uint b, out uint high, out uint low) {
    uint a_0 = a & 65535u, a_1 = a >> 16u, b_0 = b & 65535u, b_1 = b >> 16u;
    uint middle = a_1 * b_0 + (a_0 * b_0 >> 16u), other = a_0 * b_1 + (middle & 65535u);
    high = a_1 * b_1 + (middle >> 16u) + (other >> 16u);
    low = a * b;
}
uint uaddCarry(uint a, uint b, out uint carry) { uint sum = a + b; carry = sum < a ? 1u : 0u; return sum; }
uint bitfieldReverse(uint v) {
    v = (v >> 1u & 0x55555555u) | (v & 0x55555555u) << 1u;
    v = (v >> 2u & 0x33333333u) | (v & 0x33333333u) << 2u;
    v = (v >> 4u & 0x0f0f0f0fu) | (v & 0x0f0f0f0fu) << 4u;
    v = (v >> 8u & 0x00ff00ffu) | (v & 0x00ff00ffu) << 8u;
    return v >> 16u | v << 16u;
}
uvec2 bitfieldReverse(uvec2 v) { return uvec2(bitfieldReverse(v.x), bitfieldReverse(v.y)); }
int findMSB(uint v) { int i = -1; for (; v != 0u && i < 32; v >>= 1u) ++i; return i; }
int findLSB(uint v) { return findMSB(v & (~v + 1u)); }
int bitCount(uint v) { int n = 0; for (int i = 0; i < 32; ++i) n += int(v >> uint(i) & 1u); return n; }
`;

    class ShaderError extends Error {}

    // The text with spaces in place of comments and continuation lines joined by empty ones.
    function withoutComments(text) {
        return text.replace(/^\uFEFF/, "").replace(/\r\n?/g, "\n")
            .replace(/\/\/[^\n]*|\/\*[\s\S]*?(\*\/|$)/g, comment => comment.replace(/[^\n]/g, " "));
    }

    // Replaces each #include by the file's text, every file once. `find(name, includer)` returns a path or nothing. Returns lines
    // with their places.
    function expand(sources, main, find) {
        const lines = [], places = [], seen = new Set();
        const visit = file => {
            seen.add(file);
            withoutComments(sources[file]).split("\n").forEach((line, i) => {
                const name = /^\s*#\s*include\s+"([^"]*)"/.exec(line)?.[1], place = { file, line: i + 1 };
                if (name !== undefined) {
                    const path = find(name, file);
                    if (!path) throw new ShaderError(`${file}:${i + 1}: cannot find the include file "${name}"`);
                    if (!seen.has(path)) visit(path);
                    return;
                }
                const other = /[^\x00-\x7f]/u.exec(line)?.[0];
                if (other) throw new ShaderError(`${file}:${i + 1}: '${other}' is no ASCII character: GLSL knows others in comments only`);
                lines.push(line);
                places.push(place);
            });
        };
        visit(main);
        return { lines, places, files: seen };
    }

    // The structs of a text: {name: [[type, member, array size or undefined]]}.
    function structsOf(text) {
        const structs = {};
        for (const [, name, body] of withoutComments(text).matchAll(/^struct (\w+) \{([^}]*)\}/gm))
            structs[name] = [...body.matchAll(/(\w+) (\w+)(?:\[(\w+)\])?;/g)].map(([, type, member, count]) => [type, member, count]);
        return structs;
    }

    function constantsOf(text) {
        return Object.fromEntries([...text.matchAll(/^SHARED_CONSTANT (\w+) = (\d+)u;/gm)].map(([, name, value]) => [name, Number(value)]));
    }

    class Layout {
        constructor(interfaceText) {
            this.structs = structsOf(interfaceText);
            this.constants = constantsOf(interfaceText);
        }

        wordsOf(type, count) {
            const words = plainWords(type) ?? this.structs[type]?.reduce((sum, [t, , n]) => sum + this.wordsOf(t, n), 0);
            if (words === undefined) throw new ShaderError(`there is no type ${type}`);
            return words * (count === undefined ? 1 : this.constants[count]);
        }

        // The first word of a struct's member.
        offsetOf(type, member) {
            const members = this.structs[type], index = members.findIndex(([, name]) => name === member);
            return members.slice(0, index).reduce((sum, [t, , n]) => sum + this.wordsOf(t, n), 0);
        }

        // The expression that reads a value of this type at word `at`, an expression.
        reader(type, at) {
            if (this.structs[type]) {
                let first = 0;
                const members = this.structs[type].map(([t, , n]) => {
                    if (n !== undefined) throw new ShaderError(`${type} has an array: read its members one by one`);
                    first += this.wordsOf(t);
                    return this.reader(t, `${at} + ${first - this.wordsOf(t)}u`);
                });
                return `${type}(${members.join(", ")})`;
            }
            const read = /^[iu]/.test(type) ? "web_word" : "web_float";
            return `${type}(${Array.from({ length: this.wordsOf(type) }, (_, i) => `${read}(${at} + ${i}u)`).join(", ")})`;
        }

        // Functions that read `name[i]` and, for a struct, its members.
        accessors(type, name, binding) {
            const first = `web_places[${binding}].x`, at = `${first} + ${this.wordsOf(type)}u * i`, functions = [], struct = this.structs[type];
            if (!struct?.some(([, , n]) => n !== undefined)) functions.push(`${type} ${name}_at(uint i) { return ${this.reader(type, at)}; }`);
            // Arrays begin at a texel.
            if (type === "uvec4") return `uvec4 ${name}_at(uint i) { return web_texel(int((${first} >> 2u) + i)); }`;
            let place = 0;
            for (const [t, member, n] of struct ?? []) {
                const index = n === undefined ? "" : ", uint j", offset = n === undefined ? "" : ` + ${this.wordsOf(t)}u * j`;
                functions.push(`${t} ${name}_${member}_at(uint i${index}) { return ${this.reader(t, `${at} + ${place}u${offset}`)}; }`);
                place += this.wordsOf(t, n);
            }
            return functions.join(" ");
        }
    }

    // The index behind the bracket that opens at `start`.
    function closing(text, start) {
        const open = text[start], close = { "(": ")", "[": "]", "{": "}" }[open];
        for (let i = start, depth = 0; i < text.length; ++i) {
            if (text[i] === open) ++depth;
            if (text[i] === close && --depth === 0) return i + 1;
        }
        return -1;
    }

    // Replaces each `name[index]`: `replacement(index, end)` returns the text instead, and the place behind what it stands for.
    function replaceIndexed(text, name, replacement) {
        const use = new RegExp(`\\b${name}\\s*\\[`, "g");
        let result = "", done = 0;
        for (let match; (match = use.exec(text));) {
            const start = use.lastIndex, end = closing(text, start - 1);
            if (end < 0) break;
            const [other, next] = replacement(text.slice(start, end - 1), end);
            result += text.slice(done, match.index) + other;
            done = use.lastIndex = next;
        }
        return result + text.slice(done);
    }

    // Replaces uses of a buffer, `name[i]` and `name[i].member[j]`, by calls of its accessors.
    function replaceUses(text, name, struct) {
        return replaceIndexed(text, name, (inside, end) => {
            const index = `uint(${replaceUses(inside, name, struct)})`, member = /^\s*\.\s*(\w+)/.exec(text.slice(end));
            const found = member && struct?.find(([, m]) => m === member[1]);
            if (!found) return [`${name}_at(${index})`, end];
            const next = end + member[0].length, close = found[2] !== undefined && text[next] === "[" ? closing(text, next) : next;
            const indices = close === next ? index : `${index}, uint(${text.slice(next + 1, close - 1)})`;
            return [`${name}_${found[1]}_at(${indices})`, close];
        });
    }

    // Asks is_loop_stuck() before each turn of a loop. `placeOf(line)` returns the number of a place in an estimator's file, or 0. The
    // condition moves to the start of a body in braces, since ANGLE makes two copies of one that calls functions, and compilers for
    // Direct3D take several times as long.
    function limitLoops(text, placeOf) {
        const loop = /\b(for|while)\s*\(/g;
        let result = "", done = 0, line = 1, counted = 0;
        for (let match; (match = loop.exec(text));) {
            for (; counted < match.index; ++counted) line += text[counted] === "\n";
            const start = loop.lastIndex, end = closing(text, start - 1), place = placeOf(line), inside = text.slice(start, end - 1);
            if (end < 0 || !place) continue;
            const [first, condition, last, ...more] = match[1] === "while" ? ["", inside, ""] : inside.split(";");
            if (last === undefined || more.length || /^\s*(const\s+)?\w+\s+\w+\s*=[^=]/.test(condition)) continue;  // not what it seems, or it declares a variable
            const goesOn = `!is_loop_stuck(${place}u)` + (condition.trim() ? ` && (${condition})` : ""), brace = /^\s*\{/.exec(text.slice(end));
            if (brace) result += text.slice(done, match.index) + `${match[0].replace(/^\w+/, "for")}${first};;${last})${brace[0]} if (!(${goesOn})) break;`;
            else result += text.slice(done, start) + (match[1] === "while" ? goesOn : `${first}; ${goesOn};${last}`) + ")";
            done = end + (brace?.[0].length ?? 0);
            loop.lastIndex = done;
        }
        return result + text.slice(done);
    }

    const emptyLines = text => text.replace(/[^\n]/g, "");

    // Translates a chapter's program. `scene`: images as dump_arrays writes them; `named`: as finder() takes them.
    // Returns the text, a function from its line numbers to places, the places of loops, and whether the chapter has a sample loop
    // of its own, which renders several samples in a draw.
    function translate({ sources, chapter, named, defines, scene }) {
        const layout = new Layout(sources["shaders/interface.h"]);
        const { lines, places, files } = expand(sources, "shaders/engine/render.frag", finder(sources, chapter, named));
        let text = lines.join("\n") + "\n";
        text = text.replace(/^[ \t]*#[ \t]*(version|extension|line)\b.*$/gm, "");
        text = limitLoops(text, line => places[line - 1].file.startsWith("chapters/") ? line : 0);

        const readable = [], written = [];
        const block = /layout\(scalar[^)]*?(?:binding = (\w+))?\)\s*(readonly buffer|writeonly buffer|buffer|uniform)\s+\w+\s*\{\s*(\w+) (\w+)(\[\])?;\s*\};/g;
        text = text.replace(block, (whole, binding, kind, type, name) => {
            const rest = emptyLines(whole);
            if (kind === "uniform") return `uniform ${type} ${name};${rest}`;
            if (kind !== "readonly buffer") {
                written.push(name);
                return `${type} ${name};${rest}`;
            }
            const number = layout.constants[binding];
            readable.push({ name, struct: layout.structs[type], length: `int(web_places[${number}].y / ${layout.wordsOf(type)}u)` });
            return layout.accessors(type, name, number) + rest;
        });
        for (const { name, struct, length } of readable) {
            text = text.replace(new RegExp(`\\b${name}\\.length\\(\\)`, "g"), length);
            text = replaceUses(text, name, struct);
        }
        // A fragment has one pixel.
        for (const name of written) text = replaceIndexed(text, name, (_, end) => [name, end]);

        const textures = scene.images.filter(image => image.binding === layout.constants.BINDING_TEXTURES);
        const widths = textures.map(image => image.width), firsts = textures.map(image => image.first);
        const table = (name, numbers) => `const int ${name}[${numbers.length}] = int[](${numbers.join(", ")}); `;
        text = text.replace(/layout\([^)]*\) uniform texture2D textures\[TEXTURE_COUNT\];/, !textures.length ? "" :
            table("web_texture_widths", widths) + table("web_texture_firsts", firsts) +
            "vec4 web_texture(int i, ivec2 p) { uint w = web_word(uint(web_texture_firsts[i] + p.y * web_texture_widths[i] + p.x)); " +
            "return vec4(w & 255u, w >> 8u & 255u, w >> 16u & 255u, w >> 24u) / 255.0; }");
        text = text.replace(/texelFetch\(textures\[([^\]]+)\], (\w+), 0\)/g, "web_texture($1, $2)");
        text = text.replace(/layout\([^)]*\) uniform texture2D light_probe;/, "uniform highp sampler2D light_probe;");
        text = text.replace(/\buniform usampler2D\b/g, "uniform highp usampler2D");
        // Vectors indexed by variables: compilers for Direct3D take seconds for each.
        text = text.replace(/\b(children|ray\.origin|ray\.direction)\[([^\[\]]+)\]/g, "web_pick($1, int($2))");
        text = text.replace(/\bmix\(uvec4\(/g, "web_mix(uvec4(");

        const head = "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp usampler2D;\n" +
            ["BVH_IN_STORAGE_BUFFERS", ...defines].map(define => `#define ${define}\n`).join("") + PRELUDE;
        const headLines = head.split("\n").length - 1;
        const hasSampleLoop = files.has(`chapters/${chapter}/sample_loop.glsl`);
        return { text: head + text, place: line => places[line - headLines - 1], loop: line => places[line - 1], hasSampleLoop };
    }

    // A compiler's message as "file:line: message (hint)", the first error only.
    function readableError(log, place) {
        const match = /^ERROR: [^:\n]*:(\d+): (.*)$/m.exec(log);
        if (!match) return log.trim() || "the driver refuses the shader and does not say why";
        const at = place(Number(match[1])), hint = ERROR_HINTS.find(([pattern]) => pattern.test(match[2]))?.[1];
        return `${at ? `${at.file}:${at.line}: ` : ""}${match[2].trim()}${hint ? ` (${hint})` : ""}`;
    }

    // Where a shader's #include finds a file. A chapter's file takes the place of any that the engine includes by its bare name.
    function finder(sources, chapter, named = {}) {
        return (name, includer) => Object.hasOwn(named, name) ? named[name] : [
            ...(includer.startsWith("shaders/") ? [`chapters/${chapter}/`] : []), includer.replace(/[^/]*$/, ""), "shaders/", "shaders/world/", "chapters/"
        ].map(folder => folder + name).find(path => path in sources);
    }

    return { translate, readableError, Layout, ShaderError };
})();
