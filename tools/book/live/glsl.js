// Translates the project's shaders, GLSL 4.60 with Vulkan's buffers, to GLSL ES 3.00 for WebGL 2. Each line of the result belongs to
// one of a file.
"use strict";

live.glsl = (() => {
    const { Preprocessor, ShaderError, fail, isWord } = live.preprocessor, { Layout } = live;
    // What compilers say, and what helps; the first that fits.
    const ERROR_HINTS = [
        [/'path_trace' : no matching/, "the shader has to define vec3 path_trace(Ray ray, inout uvec2 seed)"],
        [/arrays of arrays/, "browsers have none: write float a[6] and a[3 * i + j] instead of float a[2][3] and a[i][j]"],
        [/'%' : wrong operand/, "% is for integers: mod(x, y) is for others"],
        [/dimension mismatch|not matching type/, "one number cannot stand for three, nor three for one: vec3(x) makes three of one, and v.x takes one of three"],
        [/wrong operand types|cannot convert|no operation/, "both sides need the same type: 2.0 * x instead of 2 * x, float(i) for an integer i"],
        [/'\{' : syntax error/, "is a semicolon missing before? An array's values are float[2](1.0, 2.0)"],
        [/syntax error|unexpected/, "is a semicolon or a bracket missing here or before?"],
        [/undeclared identifier|no matching overloaded function/, "is the name right, and do the types of the arguments fit?"],
        [/l-value required/, "what is const cannot be assigned"],
        [/built-in function|reserved word/, "the language of browsers keeps this name for itself: choose another"]];

    const MACROS = ["precise", "atomicAdd(place, value) (place += (value))", "nonuniformEXT(index) (index)", "BVH_IN_STORAGE_BUFFERS",
                    "__VERSION__ 460", "VULKAN 100"];
    // Functions that the ES language lacks; those of the prelude begin with web_.
    const MISSING = ["fma", "umulExtended", "uaddCarry", "bitfieldReverse", "findMSB", "findLSB", "bitCount"];
    // The engine indexes these vectors by variables: compilers for Direct3D take seconds for each.
    const PICKED = ["children [", "ray . origin [", "ray . direction ["];
    // What fragments have, and the programs' shaders have not.
    const OF_FRAGMENTS = /^(discard|dFdx|dFdy|fwidth|gl_(Frag|Front|Point)\w+)$/;
    const NO_TYPES = ["return", "else", "case", "do"];

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
            if (token.text === "}" && !open.pop()) fail(token, "this } closes nothing: is there one too many, or a { missing before?");
        }
        if (open.length) fail(open[0], "this { is never closed: a } is missing below");
    }

    // Follows the statements of a program and what they declare, so that a name is rewritten only where it means the engine's.
    class Translation {
        constructor(tokens, layout, textures) {
            Object.assign(this, { tokens, layout, textures, at: 0, result: [], loops: [], functions: new Map() });
            // From the outermost: what the engine's names mean, and nothing for names of others.
            this.scopes = [new Map(MISSING.map(name => [name, { other: `web_${name}` }])), new Map()];
        }

        get next() { return this.tokens[this.at]?.text; }
        ahead(count) { return this.tokens.slice(this.at, this.at + count).map(({ text }) => text).join(" "); }
        meaning(name) { return this.scopes.findLast(scope => scope.has(name))?.get(name); }
        declare(names) { for (const name of names) this.scopes.at(-1).set(name, undefined); }

        emit(text, place) {
            this.result.push({ text, place });
            return this.result.at(-1);
        }

        copy(count = 1) {
            for (; count > 0 && this.at < this.tokens.length; --count) this.emit(this.next, this.tokens[this.at++]);
        }

        // What a function emits, without emitting it.
        captured(emits) {
            const start = this.result.length;
            emits();
            return this.result.splice(start);
        }

        within(copies, names = []) {
            this.scopes.push(new Map());
            this.declare(names);
            copies();
            this.scopes.pop();
        }

        // The index of the bracket that closes the one at `start`, or the end.
        closing(start) {
            for (let at = start, depth = 0; at < this.tokens.length; ++at) {
                if ("([{".includes(this.tokens[at].text)) ++depth;
                if (")]}".includes(this.tokens[at].text) && --depth === 0) return at;
            }
            return this.tokens.length;
        }

        // All declarations and functions.
        run() {
            while (this.at < this.tokens.length) {
                const start = this.at, place = this.tokens[start];
                if (this.next === "layout" && place.isEngine && this.block()) continue;
                const { names, parameters } = this.until([";", "{"], this.struct());
                if (this.next === "{") {
                    this.functions.set(names.at(-1), place);
                    this.within(() => this.statements(), parameters);
                } else if (this.next === ";" || this.at === start) this.copy();
            }
        }

        // The scene's arrays, the parameters, the film and the images. Returns whether it is one of them.
        block() {
            const { layout, at, tokens } = this;
            let end = at;
            while (end < tokens.length && tokens[end].text !== ";") end = "([{".includes(tokens[end].text) ? this.closing(end) + 1 : end + 1;
            const text = this.ahead(end - at), image = /uniform texture2D (\w+)/.exec(text)?.[1];
            const [, binding, kind, block, type, name = image] = /(?:binding = (\w+) )?\) (\w+ buffer|buffer|uniform) (\w+) \{ (\w+) (\w+) (?:\[ \] )?; \}$/.exec(text) ?? [];
            if (!name) return false;
            let result = `${kind === "uniform" ? "uniform " : ""}${type} ${name};`, meaning;
            if (image) result = image === "textures" ? this.textures : `uniform highp sampler2D ${image};`;
            else if (kind === "readonly buffer") {
                const number = layout.constants[binding];
                result = `const int ${name} = 0; ${layout.accessors(type, name, number)}`;  // nobody else can have its name, as in the programs
                meaning = { members: layout.structs[type] ?? [], length: `int(web_places[${number}].y / ${layout.wordsOf(type)}u)` };
            } else if (kind !== "uniform") meaning = { isSingle: true };  // a fragment has one pixel
            this.emit(block ? `struct ${block} { int web_taken; }; ${result}` : result, tokens[at]);
            this.scopes.at(-1).set(name, meaning);
            this.at = end + 1;
            return true;
        }

        // Copies a struct up to its }, and returns whether there is one.
        struct() {
            if (this.next !== "struct") return false;
            while (this.at < this.tokens.length && this.next !== "}") this.copy();
            this.copy();
            return true;
        }

        statements() {
            this.copy();
            while (this.at < this.tokens.length && this.next !== "}") this.statement();
            this.copy();
        }

        statement() {
            const start = this.at;
            switch (this.next) {
                case "{": return this.within(() => this.statements());
                case "for": case "while": return this.within(() => this.loop());
                case "do": return this.within(() => this.doLoop());
                case "if": case "switch": case "else":
                    this.copy();
                    this.brackets();
                    this.within(() => this.statement());
                    return this.next === "else" && this.tokens[start].text === "if" ? this.statement() : undefined;
                case "case": case "default": this.until([":"]); return this.copy();
            }
            this.until([";"], this.struct());
            if (this.next === ";" || this.at === start) this.copy();
        }

        brackets() {
            if (this.next !== "(") return;
            this.copy();
            this.until([]);
            this.copy();
        }

        // The call that asks whether a loop has to end.
        isStuck(place) { return `is_loop_stuck(${this.loops.push(place)}u)`; }

        // Asks is_loop_stuck() before each turn of a loop, except of the engine's. The condition moves to the start of the body, since
        // ANGLE makes two copies of one that calls functions, and compilers for Direct3D take several times as long.
        loop() {
            const place = this.tokens[this.at], isFor = place.text === "for", end = this.closing(this.at + 1);
            const isWhole = this.tokens[this.at + 1]?.text === "(" && (!isFor || this.tokens.slice(this.at, end).filter(({ text }) => text === ";").length === 2);
            if (place.isEngine || !isWhole) {
                this.copy();
                this.brackets();
                return this.statement();
            }
            let names;
            this.emit("for (", place);
            this.at += 2;
            if (isFor) this.until([";"]);
            if (isFor) ++this.at;
            const condition = this.captured(() => ({ names } = this.until([";"])));
            this.emit("; ;", place);
            if (isFor) ++this.at;
            if (isFor) this.until([]);
            ++this.at;
            this.emit(") {", place);
            const goOn = names.length ? [...condition, { text: `; if (${this.isStuck(place)} || !${names.at(-1)}) break;`, place }] :
                [{ text: `if (${this.isStuck(place)}${condition.length ? " || !(" : ""}`, place }, ...condition, { text: `${condition.length ? ")" : ""}) break;`, place }];
            this.result.push(...goOn);
            this.statement();
            this.emit("}", place);
        }

        doLoop() {
            const place = this.tokens[this.at];
            this.copy();
            this.statement();
            if (place.isEngine || this.ahead(2) !== "while (") return;
            this.copy(2);
            this.emit(`!${this.isStuck(place)} && (`, place);
            this.until([]);
            this.emit(")", place);
            this.copy();
        }

        // Copies what stands before one of `ends` or a closing bracket. Two words in a row declare the second one, from the end of its
        // initial value on. Returns these names, and those in brackets, a function's parameters. `isExpected`: a name follows a struct.
        until(ends, isExpected = false) {
            const start = this.at, names = [], parameters = [];
            let depth = 0, isDeclaring = isExpected, waiting = [];
            for (; this.at < this.tokens.length;) {
                const text = this.next, before = this.at > start ? this.tokens[this.at - 1].text : "";
                if (depth === 0 && (")]}".includes(text) || ends.includes(text) && !(text === "{" && before === "="))) break;
                if ("([{".includes(text)) ++depth;
                if (")]}".includes(text)) --depth;
                if (isWord(text) && (isExpected || before === "]" || isWord(before) && !NO_TYPES.includes(before))) {
                    (depth === 0 ? waiting : parameters).push(text);
                    isDeclaring ||= depth === 0;
                    isExpected = false;
                    this.copy();
                } else if (isWord(text) && before !== ".") this.word();
                else {
                    if (depth === 0 && (text === "," || text === ";")) {
                        this.declare(waiting);
                        names.push(...waiting.splice(0));
                        isExpected = isDeclaring &&= text === ",";
                    }
                    this.copy();
                }
            }
            this.declare(waiting);
            return { names: [...names, ...waiting], parameters };
        }

        // A word that is not declared here.
        word() {
            const place = this.tokens[this.at], { text, isEngine } = place, meaning = this.meaning(text), isIndexed = this.tokens[this.at + 1]?.text === "[";
            if (isEngine && this.engineWord(place)) return;
            if (!isEngine && OF_FRAGMENTS.test(text) && !this.scopes.some(scope => scope.has(text))) fail(place, `${text} is for pixels of triangles: a path tracer has no such thing`);
            if (meaning?.other) {
                ++this.at;
                this.emit(meaning.other, place);
            } else if (meaning?.members && isIndexed) this.element(place, meaning.members);
            else if (meaning?.length && this.ahead(5) === `${text} . length ( )`) {
                this.at += 5;
                this.emit(meaning.length, place);
            } else if (meaning?.isSingle && isIndexed) {
                this.copy();
                this.at = this.closing(this.at) + 1;
            } else this.copy();
        }

        // `name[i]` and `name[i].member[j]` become calls.
        element(place, members) {
            const call = this.emit(`web_${place.text}`, place);
            this.at += 1;
            this.emit("(", place);
            this.index(place);
            const member = this.next === "." && members.find(([, name]) => name === this.tokens[this.at + 1]?.text);
            if (member) {
                call.text += `_${member[1]}`;
                this.at += 2;
                if (member[2] !== undefined && this.next === "[") {
                    this.emit(",", place);
                    this.index(place);
                }
            }
            this.emit(")", place);
        }

        // What stands between [ and ], as a number of this type.
        index(place, type = "uint") {
            ++this.at;
            this.emit(`${type}(`, place);
            this.until([]);
            this.emit(")", place);
            ++this.at;
        }

        // What the ES language cannot do in this way.
        engineWord(place) {
            const picked = PICKED.find(words => this.ahead(words.split(" ").length) === words);
            if (picked) {
                this.emit("web_pick(", place);
                this.copy(picked.split(" ").length - 1);
                this.emit(",", place);
                this.index(place, "int");
                this.emit(")", place);
            } else if (this.ahead(4) === "texelFetch ( textures [") {
                this.at += 3;
                this.emit("web_texture(", place);
                this.index(place, "int");
            } else if (this.ahead(4) === "mix ( uvec4 (") {
                ++this.at;
                this.emit("web_mix", place);
            } else return false;
            return true;
        }
    }

    // The tables of the textures, and the function that reads their texels from the scene's words.
    function readerOf(textures) {
        if (!textures.length) return "";
        const table = (name, numbers) => `const int ${name}[${numbers.length}] = int[](${numbers.join(", ")}); `;
        return table("web_texture_widths", textures.map(({ width }) => width)) + table("web_texture_firsts", textures.map(({ first }) => first)) +
            "vec4 web_texture(int i, ivec2 p, int level) { uint w = web_word(uint(web_texture_firsts[i] + p.y * web_texture_widths[i] + p.x)); " +
            "return vec4(w & 255u, w >> 8u & 255u, w >> 16u & 255u, w >> 24u) / 255.0; }";
    }

    // Tokens as lines, each of one place.
    function written(tokens) {
        const lines = [], places = [];
        for (const { text, place } of tokens) {
            const last = places.at(-1);
            if (last?.file === place.file && last.line === place.line) lines.at(-1).push(text);
            else {
                lines.push([text]);
                places.push(place);
            }
        }
        return { text: lines.map(words => `${words.join(" ")}\n`).join(""), places };
    }

    // Translates a chapter's program. `scene`: images as dump_arrays writes them; `named`: as finder() takes them.
    // Returns the text, functions from its line numbers and from numbers of loops to places, those of functions, and whether the chapter
    // has a sample loop of its own, which renders several samples in a draw.
    function translate({ sources, chapter, named, defines, scene }) {
        const layout = new Layout(sources["shaders/interface.h"]);
        const preprocessor = new Preprocessor(sources, finder(sources, chapter, named), [...MACROS, ...defines]);
        const tokens = preprocessor.run("shaders/engine/render.frag");
        checkBraces(tokens);
        const textures = scene.images.filter(image => image.binding === layout.constants.BINDING_TEXTURES);
        const translation = new Translation(tokens, layout, readerOf(textures));
        translation.run();
        const { text, places } = written(translation.result);
        const head = "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp usampler2D;\n" + PRELUDE;
        const headLines = head.split("\n").length - 1;
        const hasSampleLoop = [...preprocessor.files].some(file => /^chapters\/.*\/sample_loop.glsl$/.test(file));
        const { functions, loops } = translation;
        return { text: head + text, place: line => places[line - headLines - 1], loop: number => loops[number - 1], functions, hasSampleLoop };
    }

    // A compiler's message about a translated shader as "file:line: message (hint)", the first error only.
    function readableError(log, { place, functions }) {
        const [, caller, ...others] = /Recursive function call in the following call chain: (\w+)(?: <- (\w+))?/.exec(log) ?? [];
        const at = ({ file, line } = {}) => file ? `${file}:${line}: ` : "";
        if (caller) return `${at(functions.get(caller))}${caller}() calls itself${others[0] ? ` by way of ${others[0]}()` : ""}: GLSL has no recursion, write a loop`;
        const [, line, text] = /^ERROR: [^:\n]*:(\d+): (.*)$/m.exec(log) ?? [];
        if (!text) return log.trim() || "the driver refuses the shader and does not say why";
        const hint = ERROR_HINTS.find(([pattern]) => pattern.test(text))?.[1];
        return `${at(place(Number(line)))}${text.trim()}${hint ? ` (${hint})` : ""}`;
    }

    // Where a shader's #include finds a file, as the programs do: those that chapters may replace in the chapter's folder, or in that of the
    // chapter which this one continues, and so on, or in shaders/.
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
        return (name, includer) => files.get(name) ?? [includer.replace(/[^/]*$/, ""), "shaders/", "chapters/"]
            .map(folder => new URL(folder + name, "file:///").pathname.slice(1)).find(path => path in sources);
    }

    return { translate, finder, readableError, ShaderError };
})();
