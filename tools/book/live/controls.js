// The controls of a live frame: what the reader chooses, and the buttons.
"use strict";

live.Controls = (() => {
    const {element} = live;
    const VIEWS = {
        picture: "picture",
        difference: "difference to the reference",
        bias: "bias in standard errors",
        noise: "noise",
        ALBEDO: "albedo",
        NORMALS: "normals"
    };
    const LIGHTS = {both: "both", light: "light samples", bounces: "bounces"};

    const button = (text, click) => element("button", {type: "button", click}, text);
    const label = (text, ...parts) => element("label", {}, text, ...parts);
    const select = (options, change) =>
        element("select", {change}, ...options.map(([value, text]) => element("option", {value}, text)));
    const lengthText = name => {
        const [, scene, bounces] = /^(.*)_(\d+)$/.exec(name);
        return `${scene.replaceAll("_", " ")}, up to ${bounces} bounce${bounces === "1" ? "" : "s"}`;
    };

    const defineOf = ({define, values, chosen}) => `${define} ${values[chosen.selectedIndex][1]}`;

    return class Controls {
        constructor(frame) {
            const {about: {pictures, strategies, choices, exercise, bugs}, editor} = frame, restart = () => frame.restart();
            this.isPaused = false;
            this.scene = select(pictures.map(({name}, i) => [i, lengthText(name)]), () => {
                this.length.value = this.sky.value = "";
                restart();
            });
            this.view = select(Object.entries(VIEWS), () => frame.viewChanged());
            this.strategy = select(strategies.map(name => [name, LIGHTS[name]]), restart);
            this.choices =
                choices.map(choice => ({
                                ...choice,
                                define: choice.name.slice(2).replaceAll("-", "_").toUpperCase(),
                                chosen: select(choice.values.map(([name], i) => [i, name.replaceAll("_", " ")]), restart)
                            }));
            this.length =
                element("input", {type: "number", min: "0", max: "100", step: "1", placeholder: "as above", change: restart});
            const hint = "radiance of the sky: three numbers, such as 1,1,1";
            this.sky = element("input", {
                type: "text",
                size: "7",
                placeholder: "the scene's",
                title: hint,
                change: () => {
                    this.sky.setCustomValidity(this.sky.value && !this.background ? hint : "");
                    if (this.sky.reportValidity()) restart();
                }
            });
            const goBack = () => {
                frame.picture.root.focus({preventScroll: true});  // since the button hides itself
                frame.picture.resetCamera();
            };
            this.firstCamera = element("button", {type: "button", hidden: "", title: "F", click: goBack}, "First camera");
            this.compared = element("input", {type: "checkbox", change: restart});
            this.pause = button("Pause", () => frame.setPaused(!this.isPaused));
            const bug = select([["", "none"], ...bugs.map((_, i) => [i, `number ${i + 1}`])], () => frame.plant(bugs[bug.value]));
            const startExercise = () => {
                const text = live.sources[exercise.file].replace(exercise.find, () => exercise.replace);
                editor.replace({...editor.state, [exercise.file]: text}, exercise.file);
                editor.selectTodo();
            };
            const fillWindow = () => document.fullscreenElement ? document.exitFullscreen() : frame.root.requestFullscreen();
            this.root = element(
                "div", {class: "live-controls", role: "group", "aria-label": "controls of the picture"},
                label("Scene ", this.scene), label("Show ", this.view),
                ...(strategies.length > 1 ? [label("Light by ", this.strategy)] : []),
                ...this.choices.map(({name, chosen}) => label(`${name.slice(2).replaceAll("-", " ")} `, chosen)),
                label("Bounces ", this.length), label("Background ", this.sky),
                ...(pictures.some(({before}) => before) ? [label(this.compared, " compare with the chapter before")] : []),
                this.firstCamera, this.pause, button("Restart", restart), button("Check", () => frame.check()),
                ...(exercise ? [button("Start exercise 1", startExercise)] : []),
                ...(bugs.length ? [label("Bug to find ", bug)] : []), button("Original text", () => editor.replace({})),
                editor.back, button("Download", () => editor.download()), button("Open", () => editor.openFile()),
                button("Copy a link", () => frame.copyLink()),
                ...(document.fullscreenEnabled ? [button("Full window", fillWindow)] : []));
        }

        // Whether surfaces are shown instead of radiance.
        get isView() { return /^[A-Z]/.test(this.view.value); }

        // The defines of the page's own options: those of choices that are not the first, which the shader knows. A filter comes
        // after it.
        get options() {
            const strategy = this.strategy.value ? [`STRATEGY STRATEGY_${this.strategy.value.toUpperCase()}`] : [];
            const made = this.choices.filter(({chosen, passes}) => chosen.selectedIndex > 0 && !passes);
            return [...strategy, ...made.map(defineOf)];
        }

        // The filter of the picture, with the number of its passes, or nothing.
        get filter() {
            const choice = this.choices.find(({chosen, passes}) => chosen.selectedIndex > 0 && passes);
            return choice && !this.isView ? {define: defineOf(choice), passes: choice.passes[choice.chosen.selectedIndex]} :
                                            undefined;
        }

        // What the picture shows instead of radiance, or nothing.
        get shownInstead() { return this.choices.find(({chosen, shows}) => chosen.selectedIndex > 0 && shows)?.shows; }

        // The radiance of the sky, if it is not that of the scene, as --background takes it.
        get background() {
            const parts = this.sky.value.split(",").map(part => part.trim()), numbers = parts.map(Number);
            const isColour = parts.length === 3 && parts.every(part => part) && numbers.every(n => n >= 0 && n < 1e30);
            return isColour ? numbers : null;
        }

        setPaused(isPaused) {
            this.isPaused = isPaused;
            this.pause.textContent = isPaused ? "Go on" : "Pause";
        }

        // The choices that references have.
        reset() {
            this.compared.checked = false;
            this.view.value = "picture";
            this.length.value = this.sky.value = "";
            if (this.strategy.value) this.strategy.selectedIndex = 0;
            for (const {chosen} of this.choices) chosen.selectedIndex = 0;
        }
    };
})();
