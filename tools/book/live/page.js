// The live frame of a chapter's page: picture, verdict, error over samples, and the controls.
"use strict";

live.page = (() => {
    const {element, plot: {percent, drawOverlay, plotOf}} = live;
    const TYPING = 600;  // milliseconds after the last key until the picture starts again
    const ENOUGH = 16;   // samples of a picture that show that the device bears the shader

    class Frame {
        // `keepsTexts`: whether the reader's texts are read and stored.
        constructor(root, keepsTexts = true) {
            Object.assign(this, {root, keepsTexts, isVisible: true});
            this.chapter = root.dataset.chapter;
            this.about = live.chapters[this.chapter];
            this.bug = this.about.bugs[root.dataset.bug - 1];
            if (root.dataset.bug && !this.bug) return;  // a student's book has none
            const name = this.bug ? "Find this bug here" : "Render this chapter here", click = () => this.startByHand();
            const words = [
                "It runs in your browser: edit the shader and see whether the picture is still right. Nothing is sent anywhere. ",
                "The pictures are noisy at first, and the fan may start. Here an exercise is done when “Check” finds nothing wrong; ",
                "what says “./lab” needs the programs."
            ];
            root.append(element("button", {type: "button", class: "live-start", click}, name), element("p", {}, ...words));
        }

        // The button is gone afterwards: the keyboard goes on at the first control.
        async startByHand() {
            await this.start();
            this.root.querySelector(".live-controls select").focus({preventScroll: true});
        }

        async start() {
            this.verdict = element("p", {class: "live-verdict", role: "status", "aria-live": "polite"}, "starting …");
            this.note = element("p", {class: "live-note", role: "status"});
            this.edits = element("p", {class: "live-note live-edits", hidden: ""});
            this.plot = element("div", {class: "live-plot"});
            this.results = element("div", {class: "live-results", role: "status"});
            const say = text => {
                this.note.textContent = text;
            };
            this.editor = new live.Editor(this.chapter, () => this.edited(), say, this.keepsTexts);
            this.controls = new live.Controls(this);
            this.picture = new live.Picture(this);
            const choice = this.controls.choices.find(({chooses_material}) => chooses_material);
            this.solver = choice && new live.Solver(this, choice);
            await this.editor.readLink();
            const {root, hint, caption, path, numbers} = this.picture;
            const parts = [this.edits, root, hint, caption, path.root, this.verdict, this.plot, numbers, this.note];
            const columns = [element("div", {class: "live-picture"}, ...parts), this.editor.root];
            const solver = this.solver ? [this.solver.root] : [];
            this.root.replaceChildren(
                this.controls.root, element("div", {class: "live-columns"}, ...columns), ...solver, this.results);
            if (this.bug) {
                const place = this.about.pictures.findIndex(({name}) => name === this.root.dataset.picture);
                this.controls.scene.value = Math.max(place, 0);
                this.plant(this.bug);
            }
            this.root.classList.add("live-running");
            this.showEdits();
            try {
                this.picture.begin();
            } catch (error) {
                this.fail(error.message);
                return;
            }
            if (this.picture.renderer.device.isSlow)
                this.note.textContent ||= "This browser draws without a GPU: everything works, but slowly.";
            this.restart();
        }

        stop() {
            live.Picture.active = null;
            this.picture.stop();
            clearTimeout(this.timer);
            this.verdict.textContent = "stopped: only one frame of a page renders at a time; Restart goes on with this one";
        }

        // Puts a mistake into the chapter's own text; without one, the text that was there before the first.
        plant(bug) {
            const {editor} = this, file = bug && editor.files.find(path => live.sources[path].split(bug.find).length === 2);
            if (file) this.withoutBug ??= editor.state;
            const planted = file && {[file]: live.sources[file].replace(bug.find, () => bug.replace)};
            editor.replace(planted ?? this.withoutBug ?? editor.state);
            if (!file) this.withoutBug = undefined;
        }

        // What the reader has changed, perhaps on another page.
        showEdits() {
            const names = this.editor.edited.map(file => {
                const [, folder, name] = /^chapters\/([^/]*)\/(.*)$/.exec(file);
                return `${name} of chapter ${parseInt(folder)}${folder === this.chapter ? "" : " (on its page, too)"}`;
            });
            this.edits.hidden = !names.length;
            this.edits.textContent = `Changed by you: ${names.join("; ")}. “Original text” undoes it.`;
        }

        edited() {
            this.showEdits();
            if (this.controls.isPaused) this.note.textContent = "Paused: press Go on to see what your change does.";
            clearTimeout(this.timer);
            this.timer = setTimeout(() => this.restart(), TYPING);
        }

        setPaused(isPaused) {
            this.controls.setPaused(isPaused);
            this.note.textContent = "";
        }

        async copyLink() {
            const link = await this.editor.link();
            try {
                await navigator.clipboard.writeText(link);
                this.note.textContent = "The link is copied: it contains your text.";
            } catch {
                this.note.replaceChildren(
                    "The browser does not let this page copy. Copy the link, which contains your text, from here: ",
                    element("input", {readonly: "", value: link, "aria-label": "link"}));
            }
            if (link.length > 8000) this.note.append(" It is long, and some programs cut long links: rather download the text.");
        }

        fail(message) {
            this.verdict.className = "live-verdict live-failed";
            this.verdict.textContent = message;
        }

        viewChanged() {
            const {isView} = this.controls;
            if (isView || this.showsView)
                this.restart();
            else if (this.film)
                this.drawOverlay();
            this.showsView = isView;
        }

        drawOverlay() { drawOverlay(this.picture.overlay, this.controls.view.value, this); }

        async restart() {
            if (!this.activate()) return;
            const {picture} = this;
            this.forgetFilm();
            this.results.replaceChildren();
            if (this.editor.error.hasChildNodes()) {  // which may be mended
                this.editor.showError("");
                this.verdict.className = "live-verdict";
                this.verdict.textContent = "compiling …";
            }
            try {
                const chosen = this.about.pictures[this.controls.scene.value];
                await picture.render(chosen, () => live.Picture.MOST_SAMPLES, (...latest) => this.show(...latest));
            } catch (error) { this.report(error); }
        }

        forgetFilm() {
            this.film = null;
            this.drawOverlay();
            this.controls.firstCamera.hidden = !this.picture.camera?.hasMoved;
        }

        // What renders begins anew by itself, unless it has ended. A check is over.
        cameraMoved() {
            const {picture: {renderings}} = this;
            this.forgetFilm();
            if (this.checking || renderings.some(({rendering}) => rendering.samples >= live.Picture.MOST_SAMPLES))
                this.restart();
            else if (renderings.length && !renderings[0].rendering.isStopped)
                this.sayVerdict();
        }

        async check() {
            if (!this.activate()) return;
            this.setPaused(false);
            this.controls.reset();
            this.solver?.reset();
            this.picture.camera?.reset();
            const checking = this.checking = live.check(this);
            try {
                await checking;
            } catch (error) { this.report(error); }
            if (this.checking === checking) this.checking = undefined;
        }

        activate() {
            if (this.picture.renderer) clearTimeout(this.timer);
            return this.picture.activate();
        }

        report(error) {
            if (this.picture.renderer.gl.isContextLost()) return;  // which has been said
            this.picture.numbers.textContent = "";
            if (error instanceof live.glsl.ShaderError) {
                this.editor.showError(error.message);
                this.fail("the shader has an error: see below the text");
            } else
                this.fail(error.message);
        }

        // `film`, `reference` and `verdict` are the latest; a scene without a reference has null in place of them.
        show(film, reference, verdict) {
            const {picture} = this, hasReference = !this.controls.isView && !picture.withoutVerdict;
            const {means, error} = hasReference ? live.statistics.relativeError(film, reference) : {};
            this.editor.showError("");
            Object.assign(this, {film, means, reference: hasReference ? reference : null, latest: verdict});
            if (film.samples >= ENOUGH) picture.losses = 0;
            this.sayVerdict();
            if (hasReference) picture.errors.push([film.samples, error]);
            const seconds = (performance.now() - picture.started) / 1000, speed = (film.rays / seconds / 1e6).toFixed(2);
            const numbers = [`${film.samples} samples a pixel, ${seconds.toFixed(1)} s, ${speed} million rays per second`];
            if (film.samples > 1 && hasReference) numbers.push(`, error ${percent(error)}`);
            if (film.invalid) numbers.push(`; ${film.invalid} samples are infinite or no numbers: their pixels are magenta`);
            picture.numbers.textContent = numbers.join("");
            this.plot.innerHTML = plotOf(picture.errors);
            this.drawOverlay();
        }

        // The latest verdict, or why there is none.
        sayVerdict() {
            const {film, latest, picture: {withoutVerdict}, controls: {isView}} = this, verdict = latest?.verdict;
            this.verdict.className = "live-verdict";
            if (isView)
                this.verdict.textContent = "this view shows surfaces, not light";
            else if (withoutVerdict || !film?.rays)
                this.verdict.textContent = `no verdict: ${withoutVerdict || "the shader traces no ray"}`;
            else {
                this.verdict.textContent = latest.text;
                if (verdict) this.verdict.classList.add(verdict.isBiased ? "live-biased" : "live-agrees");
            }
        }
    }

    // Under each block that is a whole estimator, a button that puts it into a frame.
    function offerBlocks(frame) {
        for (const block of document.querySelectorAll("pre")) {
            const text = block.textContent;
            if (!text.startsWith("vec3 path_trace(")) continue;
            const click = async () => {
                if (!frame.editor) await frame.start();
                frame.editor.replace({[`chapters/${frame.chapter}/path_trace.glsl`]: text});
                frame.root.scrollIntoView();
            };
            block.after(element("button", {type: "button", class: "live-block", click}, "Put this into the frame"));
        }
    }

    function init() {
        for (const root of document.querySelectorAll("div.live")) {
            root.replaceChildren();
            if (root.dataset.chapter === "report") root.report = new live.Report(root, Frame);
            if (!(root.dataset.chapter in live.chapters)) continue;
            root.frame = new Frame(root, !root.dataset.bug);
            if ("steps" in root.dataset) offerBlocks(root.frame);
            new IntersectionObserver(entries => {
                root.frame.isVisible = entries.at(-1).isIntersecting;
            }).observe(root);
        }
    }
    if (document.readyState === "loading")
        addEventListener("DOMContentLoaded", init);
    else
        init();
    return {Frame};
})();
