// The path of a clicked pixel, drawn over the picture and listed below it, in the words of common/viewer/inspection_panel.cpp.
"use strict";

live.PathPanel = (() => {
    const {element} = live, {record, project, projectSegment, along, distance} = live.path;
    const WIDTH = 400;  // of the drawing, in units of its lines
    const FAR = 1e3;    // where rays end that leave the scene, in distances from the camera
    const BLUE = "#3cc8ff", GREEN = "#78ff78", PINK = "#ff50c8", YELLOW = "#ffdc3c", GREY = "#787878";
    const ORANGE = "#ff8c28";  // the light path

    // A number as "%.3g" of C writes it: halfway between two, it is the one with an even digit.
    function short(x) {
        if (x === 0 || !Number.isFinite(x)) return String(x).toLowerCase().replace("infinity", "inf");
        const exact = x.toExponential(100), isHalfway = /\.\d[02468]50*e/.test(exact);
        const rounded = isHalfway ? exact.replace(/50*e/, "e") : x.toExponential(2);
        const [digits, exponent] = rounded.split("e").map(Number);
        if (exponent >= -4 && exponent < 3) return String(Number(rounded));
        return `${digits}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
    }
    const colour = (name, v) => `${name} RGB ${v.map(short).join(" ")}`;
    const point = (name, v) => `${name} (${v.map(short).join(", ")})`;

    const titleOf = ({parent}, i) => parent < 0 ? `x${i + 1}, seen by the camera` : `x${i + 1}, after x${parent + 1}`;

    // What is told of a vertex.
    function linesOf(vertex, isWeighted, isOfLightPath) {
        const lines = [];
        if (vertex.survivalProbability !== null) lines.push(`survived with probability ${short(vertex.survivalProbability)}`);
        if (isWeighted) lines.push(colour("throughput", vertex.throughput));
        if (vertex.isCollision)
            lines.push(point("collides in the medium, at", vertex.position));
        else if (vertex.isHit)
            lines.push(point("position", vertex.position), point("normal", vertex.normal));
        else
            lines.push(point("leaves the scene towards", vertex.direction));
        for (const light of vertex.lightSamples) {
            const sample = light.point ? "light sample at" : "light sample of the sky, towards";
            lines.push(point(isOfLightPath ? "seen from the camera, at" : sample, light.point ?? light.direction));
            lines.push(light.isVisible ? colour("  visible: adds", light.radiance) : "  hidden: adds nothing");
        }
        if (vertex.radiance.some(part => part !== 0) && !isOfLightPath) lines.push(colour("radiance found", vertex.radiance));
        for (const probability of vertex.lostRoulettes) lines.push(`Russian roulette: ended, survival ${short(probability)}`);
        return lines;
    }

    // A path, and the light path beside it, as the lines and points of an SVG.
    function drawingOf({vertices, lightPath}, camera, chosen, height) {
        const at = ([x, y]) => [(WIDTH * x).toFixed(1), (height * y).toFixed(1)];
        const isInScene = ({isHit, isCollision}) => isHit || isCollision, parts = [];
        const line = (from, to, stroke, width) => {
            const ends = projectSegment(camera, from, to);
            if (!ends) return;
            const [[x1, y1], [x2, y2]] = ends.map(at);
            parts.push(`<line x1="${x1}" y1="${y1}" x2="${x2}" y2="${y2}" stroke="${stroke}" stroke-width="${width}"/>`);
        };
        const farAway = (start, direction) => along(start, FAR * distance(start, camera.position), direction);
        const shadowRays = (vertices, stroke) => {
            for (const {start, point, direction, isVisible} of vertices.flatMap(vertex => vertex.lightSamples))
                line(start, point ?? farAway(start, direction), isVisible ? stroke : GREY, 1);
        };
        const ray = (vertex, start, stroke) =>
            line(start, isInScene(vertex) ? vertex.position : farAway(start, vertex.direction), stroke, 2);
        const dot = (vertex, name, radius, fill) => {
            const place = isInScene(vertex) && project(camera, vertex.position);
            if (!place) return;
            const [x, y] = at(place);
            parts.push(`<circle cx="${x}" cy="${y}" r="${radius}" fill="${fill}"/>`);
            parts.push(`<text x="${x}" y="${y}" dx="7" dy="4" fill="${fill}">${name}</text>`);
        };
        shadowRays(lightPath, ORANGE);
        lightPath.forEach((vertex, i) => {
            ray(vertex, lightPath[vertex.parent]?.position ?? vertex.origin, ORANGE);
            dot(vertex, `y${i + 1}`, 3.5, ORANGE);
        });
        shadowRays(vertices, YELLOW);
        for (const vertex of vertices.filter(({parent}) => parent >= 0)) ray(vertex, vertices[vertex.parent].position, BLUE);
        vertices.forEach((vertex, i) => {
            const fill = i === chosen ? PINK : vertex.isCollision ? GREEN : BLUE;
            dot(vertex, `x${i + 1}`, i === chosen ? 5 : 3.5, fill);
        });
        return `<svg viewBox="0 0 ${WIDTH} ${height}">${parts.join("")}</svg>`;
    }

    return class PathPanel {
        constructor(picture) {
            this.picture = picture;
            this.drawing = element("div", {class: "live-path-drawing", "aria-hidden": "true"});
            this.title = element("strong");
            this.radiance = element("span", {role: "status"});
            this.list = element("div", {class: "live-path-list", tabindex: "0", role: "group", "aria-label": "the hits"});
            const button = (text, name, click) =>
                element("button", {type: "button", "aria-label": name, title: name, click}, text);
            const sampleButtons =
                [button("<", "the sample before", () => this.step(-1)), " ", button(">", "the next sample", () => this.step(1))];
            const leave = button("Leave it", "leave the path", () => this.select(null));
            const head = element("p", {}, ...sampleButtons, " ", this.radiance, " ", leave);
            this.root = element("section", {class: "live-path", hidden: ""}, element("p", {}, this.title), head, this.list);
        }

        // Follows the first sample of a pixel, or nothing if it is null.
        select(pixel) {
            this.selection = pixel && {pixel, sample: 0, vertex: 0};
            this.update();
        }

        step(by) {
            this.selection.sample = Math.max(this.selection.sample + by, 0);
            this.update();
        }

        // Follows the selected sample as the picture now is.
        async update() {
            this.isOutdated = true;
            this.root.hidden = this.drawing.hidden = !this.selection;
            if (this.isRecording) return;
            this.isRecording = true;
            while (this.isOutdated && this.selection) {
                this.isOutdated = false;
                this.path = undefined;
                try {
                    this.path = await this.record();
                } catch (error) { this.radiance.textContent = error.message; }
                if (this.selection) this.show();
            }
            this.isRecording = false;
        }

        // The path; nothing while no picture renders.
        async record() {
            const {selection: {pixel, sample}, picture: {renderer, renderings: [own]}} = this;
            if (!own) return undefined;
            this.radiance.textContent = "";
            if (!own.recorder) this.radiance.textContent = "compiling the recorder …";
            own.recorder ??= this.compile(own);
            const {linked, translated} = await own.recorder;
            if (own.rendering.isStopped || renderer.gl.isContextLost()) return undefined;
            const path = record(renderer, {...own, linked}, pixel, sample);
            if (!path.stuck) return path;
            const {file, line} = translated.loop(path.stuck);
            throw new Error(`${file}:${line}: this loop does not end`);
        }

        async compile({chapter, sources, defines, scene}) {
            const translated = live.glsl.translate({sources, chapter, defines, scene, ...live.glsl.recorderOf(sources, chapter)});
            return {translated, linked: await this.picture.renderer.compile(translated)};
        }

        show() {
            const {path, selection, picture: {camera, renderings: [own]}} = this, {sample, pixel} = selection;
            this.title.textContent = `A path: sample ${sample} of pixel (${pixel.join(", ")})`;
            this.list.replaceChildren();
            this.drawing.replaceChildren();
            if (!path) return;
            const {vertices} = path, isWeighted = path.hasThroughput || vertices.length === 1,
                  [width, height] = own.rendering.size;
            this.radiance.textContent = colour("this sample's radiance", path.radiance);
            if (!path.isComplete) this.list.append(element("p", {}, "too long to be shown as a whole"));
            if (!isWeighted) this.list.append(element("p", {}, "the shader has no variable `throughput` to follow"));
            const chosen = Math.min(selection.vertex, vertices.length - 1);
            vertices.forEach((vertex, i) => {
                const choose = () => {
                    selection.vertex = i;
                    this.show();
                    this.list.querySelectorAll("button")[i].focus({preventScroll: true});
                };
                const title = element("button", {type: "button", "aria-pressed": String(i === chosen), click: choose});
                title.append(titleOf(vertex, i));
                this.list.append(title, element("pre", {}, linesOf(vertex, isWeighted, false).join("\n")));
            });
            path.lightPath.forEach((vertex, i) => {
                const title = element("strong", {style: `color: ${ORANGE}`}, `y${i + 1}, bounce ${i + 1} of the light path`);
                this.list.append(title, element("pre", {}, linesOf(vertex, isWeighted, true).join("\n")));
            });
            this.drawing.innerHTML = drawingOf(path, camera, chosen, WIDTH * height / width);
        }
    };
})();
