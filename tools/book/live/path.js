// Follows a single path, as common/inspection/path_recorder.cpp does: what its events are, and the vertices that they make.
"use strict";

live.path = (() => {
    const {Rendering} = live.rendering, {Layout} = live;
    const MOST_EVENTS = 1024, HALF = 12;  // words of an event in each of the two rows of a recording
    const STUCK = 0x80000000, NO_EVENT = 0x7fffffff, NO_FLIGHT = -1, NO_LIMIT = 3.4028234663852886e38;
    const SHORTENED = 1 - 2 ** -18;  // as chapter 13 does: flights that end close to a surface end there

    const difference = (a, b) => a.map((x, i) => x - b[i]);
    const along = (origin, t, direction) => origin.map((x, i) => x + t * direction[i]);
    const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
    const distance = (a, b) => Math.hypot(...difference(a, b));
    const normalized = a => a.map(x => x / Math.hypot(...a));

    // Turns events into vertices. The names and the reasons are those of the C++ class.
    class PathBuilder {
        constructor(events, kinds) {
            Object.assign(this, {events, kinds, next: 0, site: -1, throughput: [1, 1, 1], survivalProbability: null});
            Object.assign(this, {radiances: {}, latestVariable: 0, isLightSampled: false});
            this.hasFlights = events.some(event => this.hasFlight(event));
            this.path = {radiance: [0, 0, 0], vertices: [], hasThroughput: false};
        }

        hasFlight({kind, flight}) { return kind === this.kinds.RAY && flight !== NO_FLIGHT; }
        looksForBoundaries(event) { return this.hasFlights && !this.hasFlight(event); }
        isRay({kind}) { return kind === this.kinds.RAY || kind === this.kinds.SHADOW_RAY; }

        build() {
            const {kinds, events, path} = this;
            while (this.next < events.length) {
                const event = events[this.next++];
                switch (event.kind) {
                    case kinds.RAY:
                        if (this.looksForBoundaries(event))
                            this.addLightSample(event);
                        else
                            this.addVertex(event);
                        break;
                    case kinds.SHADOW_RAY:
                        this.addLightSample(event);
                        break;
                    case kinds.THROUGHPUT_STARTS:
                        this.endRoulette();
                        this.startBranch();
                    // falls through
                    case kinds.THROUGHPUT:
                        this.throughput = event.value;
                        path.hasThroughput = true;
                        break;
                    case kinds.RADIANCE_STARTS:
                    case kinds.RADIANCE:
                        this.addRadiance(event);
                        break;
                    case kinds.SPLAT:
                        this.addSplat(event);
                        break;
                    case kinds.SURVIVAL:
                        this.endRoulette();
                        this.survivalProbability = event.value[0];
                        break;
                    case kinds.RESULT:
                        path.radiance = event.value;
                }
            }
            this.endRoulette();
            return path;
        }

        // The nearest vertex, and the latest of several in one place; -1 is the camera.
        vertexAt(origin) {
            let nearest = -1, smallest = Infinity;
            for (let i = this.path.vertices.length; i-- > 0;) {
                const vertex = this.path.vertices[i], far = distance(vertex.position, origin);
                if (!(vertex.isHit || vertex.isCollision) || far >= smallest) continue;
                smallest = far;
                nearest = i;
            }
            return nearest;
        }

        addVertex(event) {
            const {origin, direction, flight} = event;
            const vertex = {
                parent: this.vertexAt(origin),
                origin,
                direction: normalized(direction),
                isHit: event.is_hit !== 0,
                isCollision: false,
                position: event.position,
                normal: event.normal,
                throughput: this.throughput,
                survivalProbability: this.survivalProbability,
                lightSamples: [],
                radiance: [0, 0, 0],
                lostRoulettes: []
            };
            this.survivalProbability = null;
            const end = vertex.isHit ? SHORTENED * distance(vertex.position, origin) : NO_LIMIT;
            if (this.hasFlight(event) && flight < end) {
                const collision =
                    {isHit: false, isCollision: true, position: along(origin, flight, direction), normal: [0, 0, 0]};
                Object.assign(vertex, collision);
            }
            this.site = this.path.vertices.push(vertex) - 1;
            this.isLightSampled = false;
        }

        // Whether a ray goes on behind the boundary that ended the ray before.
        goesOn(event) {
            const before = this.events[this.next - 2], {kinds} = this;
            if (!before || event.kind !== kinds.RAY || before.kind !== kinds.RAY) return false;
            if (!this.looksForBoundaries(before) || before.is_hit === 0) return false;
            const size = Math.hypot(...event.origin) + distance(before.origin, before.position);
            return distance(before.position, event.origin) <= 1e-4 * size;
        }

        addLightSample(event) {
            const {origin, direction, end} = event, isVisible = event.is_hit === 0, {vertices} = this.path;
            if (this.goesOn(event)) {
                if (this.isLightSampled) vertices[this.site].lightSamples.at(-1).isVisible = isVisible;
                return;
            }
            this.site = this.vertexAt(origin);
            this.isLightSampled = this.site >= 0;
            if (!this.isLightSampled) return;
            const point = end < NO_LIMIT ? along(origin, end, direction) : null;
            const light = {start: origin, direction: normalized(direction), point, isVisible, radiance: [0, 0, 0]};
            vertices[this.site].lightSamples.push(light);
        }

        // What follows happens at the origin of the branch's first ray.
        startBranch() {
            this.isLightSampled = false;
            const ray = this.events.slice(this.next).find(event => this.isRay(event));
            if (ray) this.site = this.vertexAt(ray.origin);
        }

        addRadiance({kind, value, variable}) {
            const {kinds, radiances, path: {vertices}} = this;
            const before = kind === kinds.RADIANCE_STARTS ? [0, 0, 0] : radiances[variable] ?? [0, 0, 0];
            // A sum over branches repeats what was added within them.
            const isSum = kind === kinds.RADIANCE && variable !== this.latestVariable;
            radiances[variable] = value;
            this.latestVariable = variable;
            if (isSum || this.site < 0) return;
            const vertex = vertices[this.site], added = difference(value, before);
            vertex.radiance = vertex.radiance.map((x, i) => x + added[i]);
            if (this.isLightSampled) vertex.lightSamples.at(-1).radiance = added;
            this.isLightSampled = false;
        }

        // What the latest light sample adds, even if no variable `radiance` has said so before.
        addSplat({value}) {
            const vertex = this.path.vertices[this.site], light = vertex?.lightSamples.at(-1);
            if (!light) return;
            vertex.radiance = vertex.radiance.map((x, i) => x + value[i] - light.radiance[i]);
            light.radiance = value;
        }

        // No ray followed this survival probability: the path has ended.
        endRoulette() {
            if (this.survivalProbability !== null && this.site >= 0)
                this.path.vertices[this.site].lostRoulettes.push(this.survivalProbability);
            this.survivalProbability = null;
        }
    }

    // The path from the camera, and the one from the lamp beside it, which starts first.
    function pathOf(events, kinds) {
        const begin = events.findLastIndex(({kind}) => kind === kinds.START) + 1;
        const path = new PathBuilder(events.slice(begin), kinds).build();
        return {...path, lightPath: new PathBuilder(events.slice(0, begin), kinds).build().vertices};
    }

    // {RAY: 0, …} and a function that reads an event from its words.
    function formatOf(sources) {
        const layout = new Layout(sources["shaders/interface.h"] + sources["shaders/observation/recorded_path.h"]);
        const members = layout.structs.RecordedEvent.map(([type, name]) => [type, name, layout.offsetOf("RecordedEvent", name)]);
        const names = Object.entries(layout.constants).filter(([name]) => name.startsWith("EVENT_"));
        const eventOf = words => {
            const floats = new Float32Array(words.buffer),
                  value = (type, at) => type === "uint" ? words[at] :
                type === "float"                        ? floats[at] :
                                                          [...floats.subarray(at, at + layout.wordsOf(type))];
            return Object.fromEntries(members.map(([type, name, at]) => [name, value(type, at)]));
        };
        return {kinds: Object.fromEntries(names.map(([name, number]) => [name.slice(6), number])), eventOf};
    }

    // Records a sample of a pixel of a picture that renders, with a program of record_path.frag. Returns the path, or {stuck: the
    // number of a loop that does not end}.
    function record(renderer, {linked, scene, parameters, sources, rendering: {turns}}, [x, y], sample) {
        const {gl, layout} = renderer, {kinds, eventOf} = formatOf(sources),
                   at = layout.offsetOf("RenderParameters", "image_size");
        const of_sample = parameters.slice();
        of_sample[layout.offsetOf("RenderParameters", "first_sample")] = sample;
        const rendering = new Rendering(renderer, {translated: {}, linked, scene, parameters: of_sample, size: [MOST_EVENTS, 2]});
        gl.uniform1ui(linked.place("recorded_pixel"), y * parameters[at] + x);
        gl.uniform1ui(linked.place("recorded_sample"), sample);
        rendering.turns = turns;
        rendering.draw(0, 2, 1, false);
        const texels = rendering.films[1].readWords(), words = new Uint32Array(2 * HALF), events = [];
        rendering.stop();
        for (let i = 0; i < MOST_EVENTS; ++i) {
            texels.forEach((each, part) => [0, 1].forEach(row => {
                const first = 4 * (row * MOST_EVENTS + i);
                words.set(each.subarray(first, first + 4), row * HALF + 4 * part);
            }));
            if (words[0] >= STUCK) return {stuck: words[0] - STUCK};
            if (words[0] === NO_EVENT) break;
            events.push(eventOf(words));
        }
        return {...pathOf(events, kinds), isComplete: events.length < MOST_EVENTS};
    }

    // The image position of a point, as shaders/world/camera.glsl has it; null if it is not in front of the camera.
    function project({position, forward, right, imageUp}, point) {
        const toPoint = difference(point, position), depth = dot(toPoint, forward);
        if (!(depth > 0)) return null;
        const part = axis => dot(toPoint, axis) / dot(axis, axis) / depth;
        return [0.5 + 0.5 * part(right), 0.5 - 0.5 * part(imageUp)];
    }

    // The end points of the part of a segment that is in front of the camera, or null.
    function projectSegment(camera, from, to) {
        const depth = point => dot(difference(point, camera.position), camera.forward);
        const depths = [depth(from), depth(to)], nearest = 1e-3 * Math.max(...depths);
        if (!(nearest > 0)) return null;
        const part = (nearest - depths[0]) / (depths[1] - depths[0]), cut = along(from, part, difference(to, from));
        const ends = [from, to].map((end, i) => project(camera, depths[i] < nearest ? cut : end));
        return ends.every(end => end) ? ends : null;
    }

    return {pathOf, record, project, projectSegment, along, distance};
})();
