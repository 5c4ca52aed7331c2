// Turns a shader into tokens, with includes, conditions and macros resolved: what follows sees what a compiler sees. Each token knows its
// place, for messages, and whether its text is the engine's, since only there may names be rewritten.
"use strict";

live.preprocessor = (() => {
    class ShaderError extends Error {}
    const fail = ({ file, line }, message) => { throw new ShaderError(`${file}:${line}: ${message}`); };

    const TOKEN = new RegExp([
        String.raw`(?<space>(?:\\\n|\s)+|\/\/(?:\\\n|[^\n])*|\/\*[^]*?\*\/)`, String.raw`(?<open>\/\*)`, String.raw`[A-Za-z_]\w*`,
        String.raw`(?:0[xX][\da-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\w*`, String.raw`"[^"\n]*"`,
        String.raw`<<=|>>=|\+\+|--|&&|\|\||\^\^|<<|>>|##|[-+*\/%&|^<>=!]=`, "[^]"].join("|"), "gu");
    const isWord = text => /^[A-Za-z_]/.test(text);

    // The tokens of a file. `isFirst`: of a line; `hasSpace`: before it.
    function tokensOf(file, text) {
        const tokens = [], isEngine = file.startsWith("shaders/");
        let line = 1, isFirst = true, hasSpace = true;
        for (const { 0: piece, groups: { space, open } } of text.replace(/^\uFEFF/, "").replace(/\r\n?/g, "\n").matchAll(TOKEN)) {
            const place = { file, line };
            line += piece.split("\n").length - 1;
            if (open) fail(place, "this comment is never closed: */ is missing");
            if (space) {
                hasSpace = true;
                isFirst ||= !piece.startsWith("/") && piece.replaceAll("\\\n", "").includes("\n");  // a comment is one space
                continue;
            }
            if (/[^\x00-\x7f]/u.test(piece)) fail(place, `'${piece}' is no ASCII character: GLSL knows others in comments only`);
            tokens.push({ text: piece, ...place, isEngine, isFirst, hasSpace });
            isFirst = hasSpace = false;
        }
        return tokens;
    }

    // The binary operators of an #if, the loosest first.
    const OPERATORS = [
        { "||": (a, b) => a || b }, { "&&": (a, b) => a && b }, { "|": (a, b) => a | b }, { "^": (a, b) => a ^ b }, { "&": (a, b) => a & b },
        { "==": (a, b) => a === b, "!=": (a, b) => a !== b }, { "<": (a, b) => a < b, ">": (a, b) => a > b, "<=": (a, b) => a <= b, ">=": (a, b) => a >= b },
        { "<<": (a, b) => a << b, ">>": (a, b) => a >> b }, { "+": (a, b) => a + b, "-": (a, b) => a - b },
        { "*": (a, b) => a * b, "/": (a, b) => Math.trunc(a / b), "%": (a, b) => a % b }];

    class Preprocessor {
        // `find(name, includer)` returns the path of an include file, or nothing.
        constructor(sources, find, defines) {
            Object.assign(this, { sources, find, macros: new Map(), conditions: [], files: new Set(), waiting: [], result: [] });
            for (const define of defines) this.define(tokensOf("shaders/", define));
        }

        // All tokens of a program.
        run(file) {
            this.visit(file);
            if (this.conditions.length) fail(this.conditions.at(-1).place, "this condition has no #endif");
            this.flush();
            return this.result;
        }

        // Every file is read once, even if an #if skips it, as the programs do.
        visit(file) {
            this.files.add(file);
            const tokens = tokensOf(file, this.sources[file]);
            for (let at = 0, end; at < tokens.length; at = end) {
                end = at + 1;
                if (!tokens[at].isFirst || tokens[at].text !== "#") {
                    if (this.isActive) this.waiting.push(tokens[at]);
                    continue;
                }
                while (end < tokens.length && !tokens[end].isFirst) ++end;
                const [name, ...rest] = tokens.slice(at + 1, end);
                if (name) this.directive(name, rest);
            }
        }

        get isActive() { return this.conditions.every(condition => condition.isTrue); }

        // Macros are those at this place: what has been read so far is expanded before one of them changes.
        flush() {
            this.result.push(...this.expand(this.waiting));
            this.waiting = [];
        }

        directive(name, rest) {
            const { conditions } = this, [first] = rest, begin = isTrue => conditions.push({ place: name, isTrue, wasTrue: isTrue });
            const { isActive } = this;
            switch (name.text) {
                case "include": return this.include(name, first);
                case "ifdef": case "ifndef": return begin(this.macros.has(first?.text) === (name.text === "ifdef"));
                case "if": return begin(isActive && this.isTrue(name, rest));
                case "elif": case "else": case "endif": {
                    const condition = conditions.pop();
                    if (!condition) fail(name, `#${name.text} without #if`);
                    if (name.text === "endif") return;
                    const isTrue = !condition.wasTrue && (name.text === "else" || this.isActive && this.isTrue(name, rest));
                    return conditions.push({ place: condition.place, isTrue, wasTrue: condition.wasTrue || isTrue });
                }
            }
            if (!isActive) return;
            switch (name.text) {
                case "define": case "undef":
                    this.flush();
                    if (!first || !isWord(first.text)) fail(name, `#${name.text} needs a name`);
                    return name.text === "define" ? this.define(rest) : this.macros.delete(first.text);
                case "error": return fail(name, rest.map(({ text }) => text).join(" "));
                case "version": case "extension": case "line": case "pragma": return;
                default: fail(name, `there is no directive #${name.text}`);
            }
        }

        include(place, name) {
            if (!name?.text.startsWith('"')) return this.isActive && fail(place, 'an #include needs a name in quotes, as in #include "name.glsl"');
            const path = this.find(name.text.slice(1, -1), place.file);
            if (!path) fail(place, `cannot find the include file ${name.text}`);
            if (!this.files.has(path)) this.visit(path);
        }

        // The tokens behind #define.
        define([name, ...rest]) {
            let parameters, body = rest;
            if (rest[0]?.text === "(" && !rest[0].hasSpace) {
                const end = rest.findIndex(({ text }) => text === ")");
                if (end < 0) fail(name, `the macro ${name.text} needs a ) behind its parameters`);
                parameters = rest.slice(1, end).map(({ text }) => text).filter(isWord);
                body = rest.slice(end + 1);
            }
            const before = this.macros.get(name.text), textOf = ({ parameters, body }) => [...parameters ?? [], "|", ...body.map(({ text }) => text)].join(" ");
            if (before && textOf(before) !== textOf({ parameters, body })) fail(name, `${name.text} is defined already, as something else: #undef it before`);
            this.macros.set(name.text, { parameters, body });
        }

        // Tokens with macros expanded. What comes from a macro stands where the macro is used.
        expand(tokens) {
            const input = [...tokens].reverse(), output = [];
            while (input.length) {
                const token = input.pop(), macro = token.hidden?.has(token.text) ? undefined : this.macros.get(token.text), values = new Map();
                if (!macro || macro.parameters && input.at(-1)?.text !== "(") {
                    output.push(token);
                    continue;
                }
                if (macro.parameters) {
                    const given = this.takeArguments(input, token), { parameters } = macro;
                    if (given.length !== parameters.length && !(parameters.length === 0 && given[0].length === 0))
                        fail(token, `the macro ${token.text} takes ${parameters.length} arguments instead of ${given.length}`);
                    parameters.forEach((name, i) => values.set(name, this.expand(given[i])));
                }
                const hidden = new Set([...token.hidden ?? [], token.text]), { file, line } = token;
                const body = macro.body.flatMap(part => values.get(part.text) ?? { ...part, file, line });
                input.push(...body.map(part => ({ ...part, hidden: new Set([...part.hidden ?? [], ...hidden]) })).reverse());
            }
            return output;
        }

        // The arguments of a macro, from the end of `input`, which begins with their bracket.
        takeArguments(input, place) {
            const given = [[]];
            for (let depth = 0; input.length;) {
                const token = input.pop();
                if (token.text === ")" && --depth === 0) return given;
                if (token.text === "," && depth === 1) given.push([]);
                else if (depth > 0) given.at(-1).push(token);
                if (token.text === "(") ++depth;
            }
            return fail(place, `the macro ${place.text} needs a ) behind its arguments`);
        }

        // Whether the expression of an #if or #elif is not 0. Names that are no macros are 0.
        isTrue(place, tokens) {
            const known = [];
            for (let i = 0; i < tokens.length; ++i) {
                if (tokens[i].text !== "defined") { known.push(tokens[i]); continue; }
                const hasBracket = tokens[i + 1]?.text === "(", name = tokens[i + (hasBracket ? 2 : 1)]?.text;
                known.push({ ...tokens[i], text: this.macros.has(name) ? "1" : "0" });
                i += hasBracket ? 3 : 1;
            }
            const words = this.expand(known).map(({ text }) => text).reverse(), wrong = () => fail(place, `#${place.text}: this condition is no number`);
            const value = level => {
                if (level < OPERATORS.length) {
                    let left = value(level + 1);
                    while (Object.hasOwn(OPERATORS[level], words.at(-1))) left = Number(OPERATORS[level][words.pop()](left, value(level + 1)));
                    return left;
                }
                const word = words.pop() ?? wrong();
                if (word === "!") return Number(!value(level));
                if (word === "-") return -value(level);
                if (word === "(") {
                    const inner = value(0);
                    return words.pop() === ")" ? inner : wrong();
                }
                const number = isWord(word) ? 0 : Number(word.replace(/u$/i, ""));
                return Number.isNaN(number) ? wrong() : number;
            };
            const result = value(0);
            return words.length ? wrong() : result !== 0;
        }
    }

    return { Preprocessor, ShaderError, fail, isWord };
})();
