// Where the numbers of the scene's arrays lie in the textures of a page, and the functions that read them.
"use strict";

live.Layout = (() => {
    const {ShaderError} = live.preprocessor;

    // The words of a scalar, vector or matrix, and nothing for other types.
    function plainWords(type) {
        const [, , rows, columns, rowsOfMatrix] = /^(float|u?int|[iu]?vec(\d)|mat(\d)(?:x(\d))?)$/.exec(type) ?? [];
        return rows ? Number(rows) : columns ? columns * (rowsOfMatrix ?? columns) : /^(float|u?int)$/.test(type) ? 1 : undefined;
    }

    return class Layout {
        constructor(interfaceText) {
            // {name: [[type, member, array size or undefined]]}
            this.structs = {};
            for (const [, name, body] of interfaceText.matchAll(/^struct (\w+) \{([^}]*)\}/gm))
                this.structs[name] =
                    [...body.matchAll(/(\w+) (\w+)(?:\[(\w+)\])?;/g)].map(([, type, member, count]) => [type, member, count]);
            const constants = [...interfaceText.matchAll(/^SHARED_CONSTANT (\w+) = (\d+)u;/gm)];
            this.constants = Object.fromEntries(constants.map(([, name, value]) => [name, Number(value)]));
        }

        wordsOf(type, count) {
            const words = plainWords(type) ?? this.structs[type]?.reduce((sum, [t, , n]) => sum + this.wordsOf(t, n), 0);
            if (words === undefined) throw new ShaderError(`there is no type ${type}`);
            return words * (count === undefined ? 1 : this.constants[count]);
        }

        typeOf(type, member) { return this.structs[type].find(([, name]) => name === member)[0]; }

        // The first word of a struct's member.
        offsetOf(type, member) {
            const members = this.structs[type], index = members.findIndex(([, name]) => name === member);
            return members.slice(0, index).reduce((sum, [t, , n]) => sum + this.wordsOf(t, n), 0);
        }

        // The expression that reads a value of this type, or an array of `count`, at word `at`, an expression.
        reader(type, at, count) {
            if (count !== undefined) {
                const size = this.constants[count], words = this.wordsOf(type);
                const elements = Array.from({length: size}, (_, i) => this.reader(type, `${at} + ${i * words}u`));
                return `${type}[${size}](${elements.join(", ")})`;
            }
            if (this.structs[type]) {
                let first = 0;
                const members = this.structs[type].map(([t, , n]) => {
                    first += this.wordsOf(t, n);
                    return this.reader(t, `${at} + ${first - this.wordsOf(t, n)}u`, n);
                });
                return `${type}(${members.join(", ")})`;
            }
            const read = /^[iu]/.test(type) ? "web_word" : "web_float";
            return `${type}(${Array.from({length: this.wordsOf(type)}, (_, i) => `${read}(${at} + ${i}u)`).join(", ")})`;
        }

        // Functions that read `name[i]` and, for a struct, its members, and the elements of those that are arrays.
        accessors(type, name, binding) {
            const first = `web_places[${binding}].x`, at = `${first} + ${this.wordsOf(type)}u * i`;
            // Arrays begin at a texel.
            if (type === "uvec4") return `uvec4 web_${name}(uint i) { return web_texel(int((${first} >> 2u) + i)); }`;
            const functions = [`${type} web_${name}(uint i) { return ${this.reader(type, at)}; }`];
            let place = 0;
            for (const [t, member, n] of this.structs[type] ?? []) {
                const array = n === undefined ? "" : `[${this.constants[n]}]`;
                const whole = this.reader(t, `${at} + ${place}u`, n);
                functions.push(`${t}${array} web_${name}_${member}(uint i) { return ${whole}; }`);
                if (array) {
                    const element = this.reader(t, `${at} + ${place}u + ${this.wordsOf(t)}u * j`);
                    functions.push(`${t} web_${name}_${member}(uint i, uint j) { return ${element}; }`);
                }
                place += this.wordsOf(t, n);
            }
            return functions.join(" ");
        }
    };
})();
