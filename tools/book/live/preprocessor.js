// Turns a shader into tokens, with includes, conditions and macros resolved: what follows sees what a compiler sees. Each token
// knows its place, for messages, and whether its text is the engine's, since only there may names be rewritten.
"use strict";

live.preprocessor = (() => {
    class ShaderError extends Error {}
    const fail = ({file, line}, message) => {
        throw new ShaderError(`${file}:${line}: ${message}`);
    };

    const TOKEN = new RegExp(
        [
            String.raw`(?<space>\s+|\/\/[^\n]*|\/\*[^]*?\*\/)`, String.raw`(?<open>\/\*)`, String.raw`[A-Za-z_]\w*`,
            String.raw`(?:0[xX][\da-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\w*`, String.raw`"[^"\n]*"`,
            String.raw`<<=|>>=|\+\+|--|&&|\|\||\^\^|<<|>>|##|[-+*\/%&|^<>=!]=`, "[^]"
        ].join("|"),
        "gu");
    const isWord = text => /^[A-Za-z_]/.test(text);

    // The tokens of a file, where a \ joins its line with the next one, even within a word. `isFirst`: of a line; `hasSpace`:
    // before it.
    function tokensOf(file, text) {
        const tokens = [], isEngine = file.startsWith("shaders/");
        const parts = text.replace(/^\uFEFF/, "").replace(/\r\n?/g, "\n").split("\\\n");
        let line = 1, isFirst = true, hasSpace = true, length = 0;
        const joins = parts.slice(0, -1).map(part => length += part.length);
        for (const {0: piece, index, groups: {space, open}} of parts.join("").matchAll(TOKEN)) {
            for (; joins[0] <= index; joins.shift()) ++line;
            const place = {file, line};
            line += piece.split("\n").length - 1;
            if (open) fail(place, "this comment is never closed: */ is missing");
            if (space) {
                hasSpace = true;
                isFirst ||= !piece.startsWith("/") && piece.includes("\n");  // a comment is one space
                continue;
            }
            if (piece === '"') fail(place, 'this text is never closed: a second " is missing in its line');
            tokens.push({text: piece, ...place, isEngine, isFirst, hasSpace});
            isFirst = hasSpace = false;
        }
        return tokens;
    }

    // The binary operators of an #if, the loosest first.
    const OPERATORS = [
        {"||": (a, b) => a || b}, {"&&": (a, b) => a && b}, {"|": (a, b) => a | b}, {"^": (a, b) => a ^ b},
        {"&": (a, b) => a & b}, {"==": (a, b) => a === b, "!=": (a, b) => a !== b},
        {"<": (a, b) => a < b, ">": (a, b) => a > b, "<=": (a, b) => a <= b, ">=": (a, b) => a >= b},
        {"<<": (a, b) => a << b, ">>": (a, b) => a >> b}, {"+": (a, b) => a + b, "-": (a, b) => a - b},
        {"*": (a, b) => a * b, "/": (a, b) => Math.trunc(a / b), "%": (a, b) => a % b}
    ];

    class Preprocessor {
        // `find(name, includer)` returns the path of an include file, or nothing.
        constructor(sources, find, defines) {
            Object.assign(this, {sources, find, macros: new Map(), conditions: [], files: new Set(), waiting: [], result: []});
            for (const define of defines) this.define(tokensOf("shaders/", define));
        }

        // All tokens of a program.
        run(file) {
            this.visit(file);
            if (this.conditions.length) fail(this.conditions.at(-1).place, "this condition has no #endif");
            this.flush();
            for (const token of this.result) {
                if (/[^\x00-\x7f]/u.test(token.text))
                    fail(token, `'${token.text}' is no ASCII character: GLSL knows others in comments only`);
                if (token.text.startsWith("#"))
                    fail(
                        token,
                        `${token.text} has no meaning here: # begins the line of a directive, ## joins words in a #define, and GLSL has no texts`);
            }
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
            const {conditions} = this, [first] = rest, begin = isTrue => conditions.push({place: name, isTrue, wasTrue: isTrue});
            const {isActive} = this;
            switch (name.text) {
                case "include":
                    return this.include(name, first);
                case "ifdef":
                case "ifndef":
                    return begin(this.macros.has(first?.text) === (name.text === "ifdef"));
                case "if":
                    return begin(isActive && this.isTrue(name, rest));
                case "elif":
                case "else":
                case "endif": {
                    const condition = conditions.pop();
                    if (!condition) fail(name, `#${name.text} without #if`);
                    if (name.text === "endif") return;
                    const isTrue = !condition.wasTrue && (name.text === "else" || this.isActive && this.isTrue(name, rest));
                    return conditions.push({place: condition.place, isTrue, wasTrue: condition.wasTrue || isTrue});
                }
            }
            if (!isActive) return;
            switch (name.text) {
                case "define":
                case "undef":
                    this.flush();
                    if (!first || !isWord(first.text)) fail(name, `#${name.text} needs a name`);
                    return name.text === "define" ? this.define(rest) : this.macros.delete(first.text);
                case "error":
                    return fail(name, rest.map(({text}) => text).join(" "));
                case "version":
                case "extension":
                case "line":
                case "pragma":
                    return;
                default:
                    fail(name, `there is no directive #${name.text}`);
            }
        }

        include(place, name) {
            if (!name?.text.startsWith('"'))
                return this.isActive && fail(place, 'an #include needs a name in quotes, as in #include "name.glsl"');
            const path = this.find(name.text.slice(1, -1), place.file);
            if (!path) fail(place, `cannot find the include file ${name.text}`);
            if (!this.files.has(path)) this.visit(path);
        }

        // The tokens behind #define.
        define([name, ...rest]) {
            let parameters, body = rest;
            if (rest[0]?.text === "(" && !rest[0].hasSpace) {
                const end = rest.findIndex(({text}) => text === ")");
                if (end < 0) fail(name, `the macro ${name.text} needs a ) behind its parameters`);
                parameters = rest.slice(1, end).map(({text}) => text).filter(isWord);
                body = rest.slice(end + 1);
            }
            const before = this.macros.get(name.text);
            const textOf = ({parameters, body}) => [...parameters ?? [], "|", ...body.map(({text}) => text)].join(" ");
            if (before && textOf(before) !== textOf({parameters, body}))
                fail(name, `${name.text} is defined already, as something else: #undef it before`);
            this.macros.set(name.text, {parameters, body});
        }

        // Tokens with macros expanded. What comes from a macro stands where the macro is used.
        expand(tokens) {
            const input = [...tokens].reverse(), output = [];
            while (input.length) {
                const token = input.pop(), macro = token.hidden?.has(token.text) ? undefined : this.macros.get(token.text);
                if (!macro || macro.parameters && input.at(-1)?.text !== "(") {
                    output.push(token);
                    continue;
                }
                const {parameters} = macro, given = parameters ? this.takeArguments(input, token) : [];
                if (parameters && given.length !== parameters.length && !(parameters.length === 0 && given[0].length === 0))
                    fail(token, `the macro ${token.text} takes ${parameters.length} arguments instead of ${given.length}`);
                const hide = part => ({...part, hidden: new Set([...part.hidden ?? [], ...token.hidden ?? [], token.text])});
                input.push(...this.filled(macro, given, token).map(hide).reverse());
            }
            return output;
        }

        // A macro's body at a place, with its arguments. ## joins the words beside it, arguments before they are expanded.
        filled({parameters = [], body}, given, {file, line}) {
            const result = [], isJoint = at => body[at]?.text === "##", wrong = message => fail({file, line}, message);
            body.forEach((part, i) => {
                if (isJoint(i)) return;
                const argument = given[parameters.indexOf(part.text)], isRight = isJoint(i - 1);
                const isJoined = isRight || isJoint(i + 1);
                const words = !argument ? [{...part, file, line}] : isJoined ? argument : this.expand(argument);
                if (isJoined && (!words.length || isJoint(0) || isJoint(body.length - 1))) wrong("## needs a word on both sides");
                if (!isRight) return result.push(...words);
                const left = result.pop(), [right, ...others] = words, text = left.text + right.text;
                if (text.match(TOKEN)[0] !== text) wrong(`${left.text} ## ${right.text} is no word of GLSL`);
                result.push({...left, text}, ...others);
            });
            return result;
        }

        // The arguments of a macro, from the end of `input`, which begins with their bracket.
        takeArguments(input, place) {
            const given = [[]];
            for (let depth = 0; input.length;) {
                const token = input.pop();
                if (token.text === ")" && --depth === 0) return given;
                if (token.text === "," && depth === 1)
                    given.push([]);
                else if (depth > 0)
                    given.at(-1).push(token);
                if (token.text === "(") ++depth;
            }
            return fail(place, `the macro ${place.text} needs a ) behind its arguments`);
        }

        // Whether the expression of an #if or #elif is not 0. Names that are no macros are 0.
        isTrue(place, tokens) {
            const known = [];
            for (let i = 0; i < tokens.length; ++i) {
                if (tokens[i].text !== "defined") {
                    known.push(tokens[i]);
                    continue;
                }
                const hasBracket = tokens[i + 1]?.text === "(", name = tokens[i + (hasBracket ? 2 : 1)]?.text;
                known.push({...tokens[i], text: this.macros.has(name) ? "1" : "0"});
                i += hasBracket ? 3 : 1;
            }
            const words = this.expand(known).map(({text}) => text).reverse();
            const wrong = () => fail(place, `#${place.text}: this condition is no number`);
            const value = level => {
                if (level < OPERATORS.length) {
                    let left = value(level + 1);
                    while (Object.hasOwn(OPERATORS[level], words.at(-1)))
                        left = Number(OPERATORS[level][words.pop()](left, value(level + 1)));
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

    return {Preprocessor, ShaderError, fail, isWord};
})();
