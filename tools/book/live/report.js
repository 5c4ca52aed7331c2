// The page that tries a device: what a developer wants to know about it, as a text.
"use strict";

live.Report = (() => {
    const {element} = live;

    // Tries chapters one after the other, and writes what a developer wants to know about the device.
    return class Report {
        static chapters = ["next_event_estimation", "dielectrics", "light_probes"];
        static patience = 120;  // seconds for a chapter

        constructor(root, Frame) {
            Object.assign(this, {root, Frame});
            this.text = element("textarea", {readonly: "", rows: "16", "aria-label": "the report"});
            this.frames = element("div");
            root.append(
                element("button", {type: "button", class: "live-start", click: () => this.run()}, "Try it"), this.text,
                this.frames);
        }

        say(line) { this.text.value += `${line}\n`; }

        async run() {
            this.text.value = "";
            this.say(navigator.userAgent);
            this.say(`screen ${screen.width} x ${screen.height}, ${navigator.hardwareConcurrency} threads`);
            for (const name of Report.chapters) {
                const chapter = Object.keys(live.chapters).find(folder => folder.endsWith(name));
                if (chapter) await this.try(chapter);
            }
            this.frames.replaceChildren();
            this.say("done");
        }

        // Renders a furnace: pixels that are not as bright as all others have lost rays between triangles.
        async furnace(frame) {
            const {scene, chapter, radiance, parameters} = await live.loading.loadData(this.root.dataset.folder, "furnace");
            const samples = 64;
            frame.picture.stop();
            const state = await frame.picture.prepare({scene, parameters, chapter, options: []}, live.sources);
            let film;
            await state.rendering.render({target: () => samples, look(latest) { film = latest; }});
            state.rendering.stop();
            const wrong = film.sums.filter((sum, i) => i % 3 === 0 && Math.abs(sum / samples / radiance - 1) > 1e-4).length;
            this.say(
                `\nfurnace: ${wrong} of ${film.width * film.height} pixels are wrong after ${samples} samples, ` +
                `${film.invalid} samples are no numbers`);
        }

        async try(chapter) {
            const root = element("div", {"data-chapter": chapter, "data-folder": this.root.dataset.folder});
            const started = performance.now();
            this.frames.replaceChildren(root);
            const frame = root.frame = new this.Frame(root, false), seconds = () => (performance.now() - started) / 1000;
            await frame.start();
            const {picture} = frame;
            const isFirst = chapter.endsWith(Report.chapters[0]);
            if (picture.renderer && isFirst) {
                const {gl, parallel, device} = picture.renderer, compiles = parallel ? "compiles" : "does not compile";
                const size = gl.getParameter(gl.MAX_TEXTURE_SIZE);
                this.say(`device ${device.name}; textures up to ${size}; ${compiles} beside the page`);
            }
            const isOver = () =>
                frame.latest?.verdict || frame.verdict.classList.contains("live-failed") || seconds() > Report.patience;
            while (!isOver()) await live.rendering.pause(100);
            this.say(`\n${chapter}: ${frame.verdict.textContent}`);
            if (picture.times) {
                const [compile, first] = [picture.times.compile, picture.times.first].map(time => time.toFixed(0));
                this.say(`compiled in ${compile} ms, first picture after ${first} ms; ${picture.numbers.textContent}`);
            }
            if (frame.editor.error.textContent) this.say(frame.editor.error.textContent);
            if (picture.losses) this.say(`the browser took the GPU away ${picture.losses} times`);
            if (picture.renderer && isFirst) await this.furnace(frame);
            frame.stop();
        }
    };
})();
