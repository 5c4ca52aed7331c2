// Rewrites the tokens of a program for WebGL 2: what a translation to GLSL ES 3.00 knows of its statements and declarations.
"use strict";

live.Translation = (() => {
    const {fail, isWord} = live.preprocessor;
    // Functions that the ES language lacks; those of the prelude in glsl.js begin with web_.
    const MISSING = ["fma", "umulExtended", "uaddCarry", "bitfieldReverse", "findMSB", "findLSB", "bitCount"];
    // The engine indexes these vectors by variables: compilers for Direct3D take seconds for each.
    const PICKED = ["children [", "ray . origin [", "ray . direction ["];
    // What fragments have, and the programs' shaders have not.
    const OF_FRAGMENTS = /^(discard|dFdx|dFdy|fwidth|gl_(Frag|Front|Point)\w+)$/;
    const NO_TYPES = ["return", "else", "case", "do"];

    // Follows the statements of a program and what they declare, so that a name is rewritten only where it means the engine's.
    return class Translation {
        constructor(tokens, layout, textures) {
            Object.assign(this, {tokens, layout, textures, at: 0, result: [], radiances: 0, hasFlight: false});
            Object.assign(this, {loops: [], functions: new Map()});
            // From the outermost: what the engine's names mean, and nothing for names of others.
            this.scopes = [new Map(MISSING.map(name => [name, {other: `web_${name}`}])), new Map()];
        }

        get next() { return this.tokens[this.at]?.text; }
        ahead(count) { return this.tokens.slice(this.at, this.at + count).map(({text}) => text).join(" "); }
        meaning(name) { return this.scopes.findLast(scope => scope.has(name))?.get(name); }
        declare(names) {
            for (const name of names) this.scopes.at(-1).set(name, undefined);
        }

        emit(text, place) {
            this.result.push({text, place});
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
                const {names, parameters} = this.until([";", "{"], this.struct());
                if (this.next === "{") {
                    this.functions.set(names.at(-1), place);
                    this.within(() => this.statements(), parameters);
                } else if (this.next === ";" || this.at === start)
                    this.copy();
            }
        }

        // The scene's arrays, the parameters, the film and the images. Returns whether it is one of them.
        block() {
            const {layout, at, tokens} = this;
            let end = at;
            while (end < tokens.length && tokens[end].text !== ";")
                end = "([{".includes(tokens[end].text) ? this.closing(end) + 1 : end + 1;
            const text = this.ahead(end - at), image = /uniform texture2D (\w+)/.exec(text)?.[1];
            const [, binding, kind, block, type, name = image] =
                /(?:binding = (\w+) )?\) (\w+ buffer|buffer|uniform) (\w+) \{ (\w+) (\w+) (?:\[ \] )?; \}$/.exec(text) ?? [];
            if (!name) return false;
            let result = `${kind === "uniform" ? "uniform " : ""}${type} ${name};`, meaning;
            if (image)
                result = image === "textures" ? this.textures : `uniform highp sampler2D ${image};`;
            else if (kind === "readonly buffer") {
                const number = layout.constants[binding], length = `int(web_places[${number}].y / ${layout.wordsOf(type)}u)`;
                // Nobody else can have its name, as in the programs.
                result = `const int ${name} = 0; ` + layout.accessors(type, name, number);
                meaning = {members: layout.structs[type] ?? [], length};
            } else if (kind !== "uniform")
                meaning = {isSingle: true};  // a fragment has one pixel
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
                case "{":
                    return this.within(() => this.statements());
                case "for":
                case "while":
                    return this.within(() => this.loop());
                case "do":
                    return this.within(() => this.doLoop());
                case "if":
                case "switch":
                case "else":
                    this.copy();
                    this.brackets();
                    this.within(() => this.statement());
                    return this.next === "else" && this.tokens[start].text === "if" ? this.statement() : undefined;
                case "case":
                case "default":
                    this.until([":"]);
                    return this.copy();
            }
            const place = this.tokens[start], {call, isDeclaration} = this.recordingCall(place);
            if (call && !isDeclaration) this.emit("{", place);  // since it may be the whole body of an if
            this.until([";"], this.struct());
            if (this.next === ";" || this.at === start) this.copy();
            if (call) this.emit(isDeclaration ? call : `${call} }`, place);
        }

        // The call of a function of observation/record_path that belongs behind the statement which begins here, if that file is
        // part of the program: as common/inspection/recording_calls.cpp inserts it.
        recordingCall(place) {
            const [first, second, third] = this.tokens.slice(this.at, this.at + 3).map(({text}) => text);
            const isDeclaration = (first === "vec3" || first === "float") && third === "=";
            const isMember = second === "." && (third === "throughput" || third === "radiance");
            const name = isDeclaration ? second : isMember ? third : first, value = isMember ? `${first}.${third}` : name;
            const starts = isDeclaration ? "_STARTS" : "";
            if (place.isEngine || !this.functions.has("record_throughput")) return {};
            if (name === "radiance" && isDeclaration) ++this.radiances;
            if (first === "float" && second === "flight") this.hasFlight = true;
            const calls = {
                throughput: `record_throughput(EVENT_THROUGHPUT${starts}, ${value});`,
                radiance: `record_radiance(EVENT_RADIANCE${starts}, ${value}, ${isMember ? 0 : this.radiances}u);`,
                ...(isDeclaration && {survival_probability: "record_survival(survival_probability);"}),
                ...(this.hasFlight && second !== "." && {flight: "record_flight(flight);"})
            };
            const isKnown = name !== "radiance" || isMember || this.radiances > 0;  // declared by the estimator
            return {call: isKnown && Object.hasOwn(calls, name) ? calls[name] : undefined, isDeclaration};
        }

        brackets() {
            if (this.next !== "(") return;
            this.copy();
            this.until([]);
            this.copy();
        }

        // The call that asks whether a loop has to end.
        isStuck(place) { return `is_loop_stuck(${this.loops.push(place)}u)`; }

        // Asks is_loop_stuck() before each turn of a loop, except of the engine's. The condition moves to the start of the body,
        // since ANGLE makes two copies of one that calls functions, and compilers for Direct3D take several times as long.
        loop() {
            const place = this.tokens[this.at], isFor = place.text === "for", end = this.closing(this.at + 1);
            const isWhole = this.tokens[this.at + 1]?.text === "(" &&
                (!isFor || this.tokens.slice(this.at, end).filter(({text}) => text === ";").length === 2);
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
            const condition = this.captured(() => ({names} = this.until([";"])));
            this.emit("; ;", place);
            if (isFor) ++this.at;
            if (isFor) this.until([]);
            ++this.at;
            this.emit(") {", place);
            const isStuck = this.isStuck(place);
            if (names.length) {
                this.result.push(...condition);
                this.emit(`; if (${isStuck} || !${names.at(-1)}) break;`, place);
            } else {
                this.emit(`if (${isStuck}${condition.length ? " || !(" : ""}`, place);
                this.result.push(...condition);
                this.emit(`${condition.length ? ")" : ""}) break;`, place);
            }
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

        // Copies what stands before one of `ends` or a closing bracket. Two words in a row declare the second one, from the end
        // of its initial value on. Returns these names, and those in brackets, a function's parameters. `isExpected`: a name
        // follows a struct.
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
                } else if (isWord(text) && before !== ".")
                    this.word();
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
            return {names: [...names, ...waiting], parameters};
        }

        // A word that is not declared here.
        word() {
            const place = this.tokens[this.at], {text, isEngine} = place, meaning = this.meaning(text);
            const isIndexed = this.tokens[this.at + 1]?.text === "[";
            if (isEngine && this.engineWord(place)) return;
            if (!isEngine && OF_FRAGMENTS.test(text) && !this.scopes.some(scope => scope.has(text)))
                fail(place, `${text} is for pixels of triangles: a path tracer has no such thing`);
            if (meaning?.other) {
                ++this.at;
                this.emit(meaning.other, place);
            } else if (meaning?.members && isIndexed)
                this.element(place, meaning.members);
            else if (meaning?.length && this.ahead(5) === `${text} . length ( )`) {
                this.at += 5;
                this.emit(meaning.length, place);
            } else if (meaning?.isSingle && isIndexed) {
                this.copy();
                this.at = this.closing(this.at) + 1;
            } else
                this.copy();
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
            } else
                return false;
            return true;
        }
    };
})();
