// Finds colours back from a picture, as ./lab solve does, on the page of a chapter with derivatives: the reader changes albedos,
// and least squares over derivative pictures brings them home.
"use strict";

live.Solver = (() => {
    const {element} = live;
    const SAMPLES = 16, STEPS = 5;
    const LARGEST_STEP = 1.5, LOW = 1e-3;  // of the logarithm of an albedo, and of the albedo, as in tools/lesson/solve.py

    const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
    const toSrgb = x => x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
    const toLinear = x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
    const toHex = colour => `#${colour.map(x => Math.round(255 * toSrgb(x)).toString(16).padStart(2, "0")).join("")}`;
    const fromHex = text => [1, 3, 5].map(i => toLinear(parseInt(text.slice(i, i + 2), 16) / 255));
    const inWords = colour => colour.map(x => x.toFixed(3)).join(" ");

    // The multiples of these pictures whose sum comes closest to another one in a channel: the normal equations, solved by
    // elimination. 0 for a picture that is black there.
    function leastSquares(pictures, wanted, channel) {
        const product = (a, b) => a.reduce((sum, x, i) => i % 3 === channel ? sum + x * b[i] : sum, 0);
        let rows = pictures.map(a => [...pictures, wanted].map(b => product(a, b)));
        for (const k of rows.keys())
            if (rows[k][k] > 0)
                rows = rows.map((row, i) => i === k ? row : row.map((x, j) => x - row[k] / rows[k][k] * rows[k][j]));
        return rows.map((row, k) => row[k] > 0 ? row.at(-1) / row[k] : 0);
    }

    return class Solver {
        // `choice`: that of the material whose derivative is shown.
        constructor(frame, choice) {
            Object.assign(this, {frame, choice, materials: []});
            this.inputs = element("span");
            this.button = element("button", {type: "button", click: () => this.find()}, "Find the colours");
            this.steps = element("p", {class: "live-numbers", role: "status"});
            const words = "Change colours, and let the derivatives find them back from a picture of the true ones: ";
            this.root = element("div", {class: "live-solver", hidden: ""}, words, this.inputs, " ", this.button, this.steps);
        }

        // The scene with the reader's colours. The first time it offers its matte materials.
        async changed(scene) {
            scene.words ??= await live.loading.unpackWords(scene.packed);
            if (scene !== this.scene) this.offer(scene);
            if (!this.isChanged) return scene;
            const words = scene.words.slice(), floats = new Float32Array(words.buffer);
            for (const {place, albedo} of this.materials) floats.set(albedo, place);
            return {...scene, words};
        }

        get isChanged() { return this.materials.some(({albedo, truth}) => albedo !== truth); }

        offer(scene) {
            const {layout} = this.frame.picture.renderer, floats = new Float32Array(scene.words.buffer);
            const {first, count} = scene.buffers.find(({binding}) => binding === layout.constants.BINDING_MATERIALS);
            const size = layout.wordsOf("Material"), offset = layout.offsetOf("Material", "diffuse_albedo");
            const materials = Array.from({length: Math.min(count, this.choice.values.length - 1)}, (_, i) => {
                const place = first + i * size + offset, truth = [...floats.subarray(place, place + 3)];
                return {number: i + 1, place, truth, albedo: truth};
            });
            const isLamp = ({place}) => {
                const emission = place - offset + layout.offsetOf("Material", "emission");
                return floats.subarray(emission, emission + 3).some(x => x > 0);
            };
            this.scene = scene;
            this.materials = materials.filter(material => !isLamp(material) && material.truth.every(x => x > 0));
            for (const material of this.materials) {
                const change = ({target}) => {
                    material.albedo = fromHex(target.value);
                    this.frame.restart();
                };
                material.input = element("input", {type: "color", change, "aria-label": `colour of material ${material.number}`});
            }
            this.inputs.replaceChildren(
                ...this.materials.map(({number, input}) => element("label", {}, `${number} `, input, " ")));
            this.root.hidden = !this.materials.length;
            this.reset();
        }

        show() {
            for (const {input, albedo} of this.materials) input.value = toHex(albedo);
        }

        reset() {
            for (const material of this.materials) material.albedo = material.truth;
            this.steps.textContent = "";
            this.show();
        }

        // The pixels of a picture, or of the derivative by a material; null if the reader does something else.
        async render(seed, number = 0) {
            const {frame: {about, controls, picture}, choice} = this, chosen = about.pictures[controls.scene.value];
            const options = number ? [...controls.options, `${choice.define} ${choice.values[number][1]}`] : controls.options;
            const parameters = Uint32Array.from(chosen.parameters);
            parameters[picture.renderer.layout.offsetOf("RenderParameters", "seed_key")] ^= Math.imul(seed, 0x9e3779b9);
            let film;
            const look = latest => {
                film = latest;
            };
            const isDone = await picture.render({...chosen, parameters, options, reference: null}, () => SAMPLES, look);
            return isDone ? Array.from(film.sums, sum => sum / film.samples) : null;
        }

        // Picture and derivatives have different random numbers: the product of their noise must vanish on average.
        async step(truth, number) {
            const sought = this.materials.filter(({albedo, truth}) => albedo !== truth);
            const picture = await this.render(2 * number), derivatives = [];
            for (const {number: material} of sought)
                if (picture && !derivatives.includes(null)) derivatives.push(await this.render(2 * number + 1, material));
            if (!picture || derivatives.includes(null)) return false;
            const missing = truth.map((x, i) => x - picture[i]);
            const changes = [0, 1, 2].map(channel => leastSquares(derivatives, missing, channel));
            sought.forEach((material, i) => {
                material.albedo = material.albedo.map((x, channel) => {
                    const change = clamp(changes[channel][i], -LARGEST_STEP, LARGEST_STEP);
                    return clamp(Math.max(x, LOW) * Math.exp(change), LOW, 1);
                });
            });
            this.show();
            const found = sought.map(({number, albedo}) => `material ${number}: ${inWords(albedo)}`);
            this.steps.textContent = `Step ${number} of ${STEPS}: ${found.join("; ")}`;
            return true;
        }

        async find() {
            const {frame} = this, started = this.materials.map(({albedo}) => albedo);
            if (!frame.activate()) return;
            if (!this.isChanged) {
                this.steps.textContent = "All colours are the true ones: change one first.";
                return;
            }
            frame.setPaused(false);
            frame.forgetFilm();
            frame.controls.reset();
            this.steps.textContent = "a picture of the true colours …";
            try {
                for (const material of this.materials) material.albedo = material.truth;
                const truth = await this.render(1);
                this.materials.forEach((material, i) => {
                    material.albedo = started[i];
                });
                for (let number = 1, goesOn = truth; number <= STEPS && goesOn; ++number) goesOn = await this.step(truth, number);
                if (truth) frame.restart();
            } catch (error) { frame.report(error); }
        }
    };
})();
